// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/range_rate_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace radar_dot {
namespace {

constexpr double kLongestStep = 0.6;  // s that one scan stands for
constexpr double kNameAfter = 2.0;    // s

constexpr std::size_t kLeastReturns = 8;
constexpr float kSame = 1e-4F;  // of a velocity
constexpr double kLeastChange =
    0.3;  // m/s, by which a velocity of all returns would change over their bearings

constexpr float kStillRate = 0.25F;                      // m/s
constexpr double kStillShare = 0.6;                      // of the returns
constexpr double kLeastInterval = 0.3, kMaxGap = 0.8;    // s between scans that are compared
constexpr float kFarthest = 50.F;                        // m
constexpr double kRangeGate = 0.5, kAzimuthGate = 0.04;  // m, rad
constexpr std::size_t kMostPoints = 96;
constexpr double kMemory = 2.0;  // s
constexpr double kLeastLooks = 3.0;
constexpr std::size_t kSlowest = 3;  // m/s
constexpr double kLeastFound = 0.25, kBetter = 1.6;

}  // namespace

void RangeRateWatch::add(double time, Span<const DopplerReturn> returns,
                         const Eigen::Isometry3d& T_base_from_sensor) {
  if (!std::isfinite(time) || !T_base_from_sensor.matrix().allFinite()) return;
  if (time < time_) reset();
  const double dt = std::min(time - time_, kLongestStep);
  time_ = time;
  if (returns.size() < kLeastReturns) return;
  constant_for_ = isConstant(returns) ? constant_for_ + dt : 0.0;
  constant_ = static_cast<double>(returns[0].doppler);

  const auto still = [](const DopplerReturn& each) { return std::abs(each.doppler) < kStillRate; };
  const auto count = static_cast<double>(std::count_if(returns.begin(), returns.end(), still));
  if (count < kStillShare * static_cast<double>(returns.size())) {
    points_.clear();
    looks_ = still_for_ = 0.0;
  } else if (time - seen_ >= kLeastInterval) {
    Points points;
    const std::size_t stride = (returns.size() + kMostPoints - 1) / kMostPoints;
    for (std::size_t i = 0; i < returns.size(); i += stride) {
      const DopplerReturn& each = returns[i];
      if (still(each) && each.range < kFarthest && each.bearing.allFinite())
        points.push_back((T_base_from_sensor * (each.range * each.bearing).cast<double>()).head<2>());
    }
    if (!points_.empty() && time - seen_ < kMaxGap)
      look(time - seen_, points, T_base_from_sensor.translation().head<2>());
    points_ = std::move(points);
    seen_ = time;
  }
  judge(dt);
}

bool RangeRateWatch::isConstant(Span<const DopplerReturn> returns) {
  const float value = returns[0].doppler;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const DopplerReturn& each : returns) {
    if (!(std::abs(each.doppler - value) <= kSame * std::abs(value))) return false;
    mean += each.bearing;
  }
  mean.normalize();
  float least = 1.F;
  for (const DopplerReturn& each : returns) least = std::min(least, mean.dot(each.bearing));
  return static_cast<double>(std::abs(value) * (1.F - least)) > kLeastChange;
}

/// How many of the points are seen again, were the vehicle to drive ahead at each of the speeds.
void RangeRateWatch::look(double dt, const Points& points, const Eigen::Vector2d& mount) {
  struct Polar {
    double range, azimuth;
    explicit Polar(const Eigen::Vector2d& p) : range(p.norm()), azimuth(std::atan2(p.y(), p.x())) {}
  };
  std::vector<Polar> now;
  for (const Eigen::Vector2d& point : points) now.emplace_back(point - mount);
  const double decay = std::exp(-dt / kMemory);
  looks_ = decay * looks_ + 1.0;
  for (std::size_t speed = 0; speed < kSpeeds; ++speed) {
    std::size_t found = 0;
    for (const Eigen::Vector2d& point : points_) {
      const Polar expected(point - mount - Eigen::Vector2d(static_cast<double>(speed) * dt, 0.0));
      found += std::any_of(now.begin(), now.end(), [&expected](const Polar& each) {
        return std::abs(each.range - expected.range) < kRangeGate &&
               std::abs(std::remainder(each.azimuth - expected.azimuth, 2.0 * M_PI)) < kAzimuthGate;
      });
    }
    const double share = static_cast<double>(found) / static_cast<double>(points_.size());
    found_[speed] += (share - found_[speed]) / looks_;
  }
}

void RangeRateWatch::judge(double dt) {
  const auto best = std::max_element(found_.begin() + kSlowest, found_.end());
  const double standing = std::max(found_[0], found_[1]);
  const bool comes_nearer = looks_ > kLeastLooks && *best > kLeastFound && *best > kBetter * standing;
  still_for_ = comes_nearer ? still_for_ + dt : 0.0;
  if (constant_for_ > kNameAfter) {
    verdict_ = Verdict::kConstant;
    value_ = constant_;
  } else if (still_for_ > kNameAfter) {
    verdict_ = Verdict::kStill;
    value_ = static_cast<double>(best - found_.begin());
  } else if (constant_for_ == 0.0 && still_for_ == 0.0) {
    verdict_ = Verdict::kGood;
  }
}

std::string RangeRateWatch::warning(const std::string& source) const {
  switch (verdict_) {
    case Verdict::kGood: break;
    case Verdict::kConstant:
      return fmt::format("{} has one value, {:.2f} m/s, for all returns: it is no range rate", source,
                         value_);
    case Verdict::kStill:
      return fmt::format(
          "by {} nothing moves, but the returns come nearer at about {:.0f} m/s: it is zero, constant, or "
          "compensated for the motion of the vehicle, and no range rate",
          source, value_);
  }
  return {};
}

}  // namespace radar_dot
