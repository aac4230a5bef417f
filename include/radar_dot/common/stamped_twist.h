// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace radar_dot {

/// A component of a twist with this variance or more is not observed, (m/s)^2 or (rad/s)^2.
inline constexpr double kUnobservedVariance = 1e5;

/// Velocity of the base frame, in the base frame.
struct StampedTwist {
  double time = 0.0;                                  ///< s
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s, of the origin
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s
  /// Of [linear, angular], (m/s)^2 and (rad/s)^2; zero where not requested.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  /// @param axis  of vx vy vz wx wy wz
  bool observes(Eigen::Index axis) const { return covariance(axis, axis) < kUnobservedVariance; }
};

/// The same; a vertical motion (vz, wx, wy) that it does not observe is zero: a vehicle on its wheels neither
/// climbs nor rolls nor pitches by itself.
inline StampedTwist onWheels(StampedTwist twist) {
  if (!twist.observes(2)) twist.linear.z() = 0.0;
  if (!twist.observes(3)) twist.angular.x() = 0.0;
  if (!twist.observes(4)) twist.angular.y() = 0.0;
  return twist;
}

}  // namespace radar_dot
