// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/twist_history.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <vector>

#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

using CovarianceMap = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>;

Eigen::Vector3d vectorOf(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

std::string seconds(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f s", value);
  return text.data();
}

}  // namespace

std::string twistDefect(const geometry_msgs::TwistWithCovarianceStamped& twist,
                        const std::string& base_frame) {
  if (twist.header.frame_id != base_frame) {
    return "its frame is '" + twist.header.frame_id + "', not the base frame '" + base_frame + "'";
  }
  if (!vectorOf(twist.twist.twist.linear).allFinite() || !vectorOf(twist.twist.twist.angular).allFinite() ||
      !CovarianceMap(twist.twist.covariance.data()).allFinite()) {
    return "it is not finite";
  }
  return {};
}

StampedVelocity velocityOf(const geometry_msgs::TwistWithCovarianceStamped& twist) {
  StampedVelocity velocity{twist.header.stamp.toSec(), vectorOf(twist.twist.twist.linear),
                           vectorOf(twist.twist.twist.angular)};
  const CovarianceMap covariance(twist.twist.covariance.data());
  // A vehicle on its wheels neither climbs nor rolls nor pitches by itself.
  if (covariance(2, 2) >= kUnobservedVariance) velocity.linear.z() = 0.0;
  if (covariance(3, 3) >= kUnobservedVariance) velocity.angular.x() = 0.0;
  if (covariance(4, 4) >= kUnobservedVariance) velocity.angular.y() = 0.0;
  return velocity;
}

void TwistHistory::add(const StampedVelocity& velocity) {
  if (!velocities_.empty() && velocity.time <= velocities_.back().time) return;
  velocities_.push_back(velocity);
  while (velocity.time - velocities_.front().time > duration_) velocities_.pop_front();
}

StampedVelocity TwistHistory::at(double time) const {
  const auto after = std::lower_bound(velocities_.begin(), velocities_.end(), time,
                                      [](const StampedVelocity& v, double t) { return v.time < t; });
  if (after == velocities_.begin()) return {time, velocities_.front().linear, velocities_.front().angular};
  if (after == velocities_.end()) return {time, velocities_.back().linear, velocities_.back().angular};
  const StampedVelocity& before = *std::prev(after);
  const double share = (time - before.time) / (after->time - before.time);
  return {time, before.linear + share * (after->linear - before.linear),
          before.angular + share * (after->angular - before.angular)};
}

std::optional<StampedVelocity> TwistHistory::mean(double begin, double end, double max_hold,
                                                  std::string& missing) const {
  if (velocities_.empty()) {
    missing = "no velocity was received yet";
    return std::nullopt;
  }
  if (end - velocities_.back().time > max_hold) {
    missing = "the latest velocity is " + seconds(end - velocities_.back().time) + " before the stamp";
    return std::nullopt;
  }
  if (velocities_.front().time - begin > max_hold) {
    missing = "the first velocity is " + seconds(velocities_.front().time - begin) + " after the stamp";
    return std::nullopt;
  }
  // The trapezoidal rule is exact on what is linear between these times.
  std::vector<double> times{begin};
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    const double time = velocities_[i].time;
    if (time > begin && time < end) times.push_back(time);
    const bool enters = i + 1 < velocities_.size() && time < end && velocities_[i + 1].time > begin;
    if (enters && velocities_[i + 1].time - time > max_gap_) {
      missing = "the velocities have a gap of " + seconds(velocities_[i + 1].time - time);
      return std::nullopt;
    }
  }
  times.push_back(end);
  if (end <= begin) return at(begin);
  StampedVelocity mean;
  mean.time = 0.5 * (begin + end);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double weight = 0.5 * (times[i + 1] - times[i]) / (end - begin);
    const StampedVelocity from = at(times[i]), to = at(times[i + 1]);
    mean.linear += weight * (from.linear + to.linear);
    mean.angular += weight * (from.angular + to.angular);
  }
  return mean;
}

std::optional<Eigen::Isometry3d> TwistHistory::motion(
    double begin, double end, double max_hold, std::string& missing,
    const std::optional<Eigen::Matrix3d>& R_begin_from_end) const {
  const bool reversed = end < begin;
  const std::optional<StampedVelocity> velocity =
      mean(std::min(begin, end), std::max(begin, end), max_hold, missing);
  if (!velocity) return std::nullopt;
  const double dt = std::abs(end - begin);
  std::optional<Eigen::Matrix3d> R_earlier_from_later = R_begin_from_end;
  if (R_begin_from_end && reversed) R_earlier_from_later = R_begin_from_end->transpose();
  const Eigen::Isometry3d T_earlier_from_later =
      R_earlier_from_later ? baseMotionWithRotation(velocity->linear, *R_earlier_from_later, dt)
                           : baseMotion(velocity->linear, velocity->angular, dt);
  return reversed ? T_earlier_from_later.inverse() : T_earlier_from_later;
}

}  // namespace radar_dot
