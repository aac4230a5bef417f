// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/twist_history.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <vector>

#include "radar_dot/common/base_motion.h"

namespace radar_dot {
namespace {

std::string seconds(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f s", value);
  return text.data();
}

}  // namespace

TwistHistory::Lack TwistHistory::add(const StampedTwist& twist, bool needs_yaw_rate) {
  constexpr Eigen::Index kForward = 0, kYaw = 5;
  const Lack lack{!twist.observes(kForward), needs_yaw_rate && !twist.observes(kYaw)};
  if (lack.any() || (!twists_.empty() && twist.time <= twists_.back().time)) return lack;
  twists_.push_back(onWheels(twist));
  while (twist.time - twists_.front().time > duration_) twists_.pop_front();
  return lack;
}

StampedTwist TwistHistory::at(double time) const {
  const auto after = std::lower_bound(twists_.begin(), twists_.end(), time,
                                      [](const StampedTwist& twist, double t) { return twist.time < t; });
  if (after == twists_.begin()) return {time, twists_.front().linear, twists_.front().angular};
  if (after == twists_.end()) return {time, twists_.back().linear, twists_.back().angular};
  const StampedTwist& before = *std::prev(after);
  const double share = (time - before.time) / (after->time - before.time);
  return {time, before.linear + share * (after->linear - before.linear),
          before.angular + share * (after->angular - before.angular)};
}

std::optional<StampedTwist> TwistHistory::mean(double begin, double end, double max_hold,
                                               std::string& missing) const {
  if (twists_.empty()) {
    missing = "no velocity was received yet";
    return std::nullopt;
  }
  if (end - twists_.back().time > max_hold) {
    missing = "the latest velocity is " + seconds(end - twists_.back().time) + " before the stamp";
    return std::nullopt;
  }
  if (twists_.front().time - begin > max_hold) {
    missing = "the first velocity is " + seconds(twists_.front().time - begin) + " after the stamp";
    return std::nullopt;
  }
  // The trapezoidal rule is exact on what is linear between these times.
  std::vector<double> times{begin};
  for (std::size_t i = 0; i < twists_.size(); ++i) {
    const double time = twists_[i].time;
    if (time > begin && time < end) times.push_back(time);
    const bool enters = i + 1 < twists_.size() && time < end && twists_[i + 1].time > begin;
    if (enters && twists_[i + 1].time - time > max_gap_) {
      missing = "the velocities have a gap of " + seconds(twists_[i + 1].time - time);
      return std::nullopt;
    }
  }
  times.push_back(end);
  if (end <= begin) return at(begin);
  StampedTwist mean;
  mean.time = 0.5 * (begin + end);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double weight = 0.5 * (times[i + 1] - times[i]) / (end - begin);
    const StampedTwist from = at(times[i]), to = at(times[i + 1]);
    mean.linear += weight * (from.linear + to.linear);
    mean.angular += weight * (from.angular + to.angular);
  }
  return mean;
}

IntervalMotion TwistHistory::between(double begin, double end, double max_hold, const KnownRotation* rotation,
                                     bool may_wait) const {
  IntervalMotion result;
  result.without_rotation = rotation != nullptr && !(rotation->at_begin && rotation->at_end);
  if (result.without_rotation && may_wait) {
    result.missing = "no rotation at the stamps of the images from " + rotation->source;
    return result;
  }
  const bool reversed = end < begin;
  const std::optional<StampedTwist> velocity =
      mean(std::min(begin, end), std::max(begin, end), max_hold, result.missing);
  if (!velocity) return result;
  const double dt = std::abs(end - begin);
  Eigen::Isometry3d T_earlier_from_later = baseMotion(velocity->linear, velocity->angular, dt);
  if (rotation != nullptr && !result.without_rotation) {
    Eigen::Matrix3d R = (rotation->at_begin->conjugate() * *rotation->at_end).toRotationMatrix();
    if (reversed) R.transposeInPlace();
    T_earlier_from_later = baseMotionWithRotation(velocity->linear, R, dt);
  }
  result.T_begin_from_end = reversed ? T_earlier_from_later.inverse() : T_earlier_from_later;
  return result;
}

}  // namespace radar_dot
