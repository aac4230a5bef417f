// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// Velocity of one radar over ground, from the static returns of one of its scans alone. It says nothing
/// about where the radar is mounted, so that several of them show errors of the mounts.
struct SensorVelocity {
  std::size_t radar = 0;                                ///< which radar, the same in all sweeps
  double time = 0.0;                                    ///< s, of the scan
  Eigen::Vector2d lever_arm = Eigen::Vector2d::Zero();  ///< m, of the radar in the base frame
  /// m/s, axes of the base frame, without what roll and pitch rates add
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< (m/s)^2; large where the bearings do not tell
};

/// Velocity of every radar whose scan has enough static returns, by reweighted least squares with Cauchy
/// weights.
/// @param result  a valid estimate from the same scans: where the static returns lie, and where to start.
///                Returns whose residual is not below the threshold of `params` are dynamic.
std::vector<SensorVelocity> sensorVelocities(const std::vector<RadarScan>& scans,
                                             const EgoVelocityResult& result,
                                             const EgoVelocityParams& params = {});

}  // namespace radar_dot
