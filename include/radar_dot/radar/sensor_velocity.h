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
  std::size_t radar = 0;                                 ///< which radar, the same in all sweeps
  double time = 0.0;                                     ///< s, of the scan
  Eigen::Vector2d lever_arm = Eigen::Vector2d::Zero();   ///< m, of the radar in the base frame
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();    ///< m/s, axes of the base frame
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< (m/s)^2; large where the bearings do not tell
};

/// Parameters of sensorVelocities.
struct SensorVelocityParams {
  double max_residual = 0.8;    ///< m/s; returns farther from the estimate of the sweep are dynamic
  double doppler_std = 0.12;    ///< m/s, 1 sigma of one Doppler measurement
  double azimuth_std = 0.0175;  ///< rad, 1 sigma of one bearing
  double scan_std = 0.02;       ///< m/s, 1 sigma of what all returns of a scan share
  int min_returns = 3;          ///< fewer static returns: the scan is left out
};

/// Velocity of every radar whose scan has enough static returns, by reweighted least squares with Cauchy
/// weights.
/// @param result  a valid estimate from the same scans: where the static returns lie, and where to start
std::vector<SensorVelocity> sensorVelocities(const std::vector<RadarScan>& scans,
                                             const EgoVelocityResult& result,
                                             const SensorVelocityParams& params = {});

}  // namespace radar_dot
