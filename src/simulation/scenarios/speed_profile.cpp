// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/speed_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace radar_dot::simulation {

SpeedProfile::SpeedProfile(std::vector<Knot> knots) : knots_(std::move(knots)) {
  if (knots_.empty()) throw std::invalid_argument("SpeedProfile: no knots");
  travelled_.push_back(0.0);
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    if (!(knots_[i].speed >= 0.0))
      throw std::invalid_argument(
          fmt::format("SpeedProfile: speed {} of knot {} is negative", knots_[i].speed, i));
    if (i == 0) continue;
    const double duration = knots_[i].time - knots_[i - 1].time;
    if (!(duration > 0.0))
      throw std::invalid_argument(fmt::format("SpeedProfile: time of knot {} does not grow", i));
    travelled_.push_back(travelled_.back() + 0.5 * duration * (knots_[i - 1].speed + knots_[i].speed));
  }
  travelled_at_zero_ = sinceFirstKnot(0.0);
}

namespace {

struct Place {
  const SpeedProfile::Knot* from;
  const SpeedProfile::Knot* to;  ///< the same as `from` outside the knots
  double fraction;               ///< of the way between them, in time
};

Place find(const std::vector<SpeedProfile::Knot>& knots, double time) noexcept {
  const auto next = std::upper_bound(knots.begin(), knots.end(), time,
                                     [](double value, const auto& knot) { return value < knot.time; });
  if (next == knots.begin()) return {&knots.front(), &knots.front(), 0.0};
  const auto previous = next - 1;
  if (next == knots.end()) return {&*previous, &*previous, 0.0};
  return {&*previous, &*next, (time - previous->time) / (next->time - previous->time)};
}

}  // namespace

double SpeedProfile::speed(double time_s) const noexcept {
  const auto [from, to, x] = find(knots_, time_s);
  return from->speed + (to->speed - from->speed) * x * x * (3.0 - 2.0 * x);
}

double SpeedProfile::acceleration(double time_s) const noexcept {
  const auto [from, to, x] = find(knots_, time_s);
  if (from == to) return 0.0;
  return (to->speed - from->speed) * 6.0 * x * (1.0 - x) / (to->time - from->time);
}

double SpeedProfile::sinceFirstKnot(double time_s) const noexcept {
  const auto [from, to, x] = find(knots_, time_s);
  const double before = travelled_[static_cast<std::size_t>(from - knots_.data())];
  if (from == to) return before + from->speed * (time_s - from->time);
  return before + (to->time - from->time) *
                      (from->speed * x + (to->speed - from->speed) * x * x * x * (1.0 - 0.5 * x));
}

double SpeedProfile::distance(double time_s) const noexcept {
  return sinceFirstKnot(time_s) - travelled_at_zero_;
}

SpeedProfile SpeedProfile::delayed(double delay) const {
  std::vector<Knot> later = knots_;
  for (Knot& knot : later) knot.time += delay;
  return SpeedProfile(std::move(later));
}

SpeedProfileBuilder& SpeedProfileBuilder::keep(double duration) {
  return change(knots_.back().speed, duration);
}

SpeedProfileBuilder& SpeedProfileBuilder::keepFor(double distance) {
  const double speed = knots_.back().speed;
  if (!(speed > 0.0)) throw std::invalid_argument("SpeedProfileBuilder: no way is made at speed 0");
  return keep(distance / speed);
}

SpeedProfileBuilder& SpeedProfileBuilder::change(double speed, double duration) {
  if (!(duration > 0.0)) return *this;
  travelled_ += 0.5 * duration * (knots_.back().speed + speed);
  knots_.push_back({knots_.back().time + duration, speed});
  return *this;
}

SpeedProfileBuilder& SpeedProfileBuilder::stopAfter(double distance, double braking) {
  const double speed = knots_.back().speed;
  if (!(speed > 0.0)) throw std::invalid_argument("SpeedProfileBuilder: stands already");
  const double way = std::min(distance, braking);
  keepFor(distance - way);
  return change(0.0, 2.0 * way / speed);
}

}  // namespace radar_dot::simulation
