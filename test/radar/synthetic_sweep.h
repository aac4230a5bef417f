// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot::test {

/// How a sweep is made up. The Doppler of a static point follows from rigid-body kinematics in
/// vectors (d = -u.(v + w x t)), not from the estimator's matrices.
struct SweepOptions {
  std::uint32_t seed = 1;
  std::size_t returns_per_radar = 60;
  double moving_share = 0.0;
  double doppler_sigma = 0.0;       ///< m/s
  double azimuth_sigma = 0.0;       ///< rad, of the reported bearing
  double elevation_sigma = 0.0;     ///< rad
  double half_field_of_view = 1.0;  ///< rad, azimuth
  double max_elevation = 0.0;       ///< rad; 0 = planar
  double max_target_speed = 8.0;    ///< m/s, of moving returns, added to their Doppler
  double min_target_speed = 2.0;    ///< m/s
};

struct Sweep {
  std::vector<std::vector<DopplerReturn>> returns;  ///< per radar
  std::vector<std::vector<bool>> moving;            ///< per radar and return
  std::vector<Eigen::Isometry3d> mounts;            ///< T_base_from_sensor
  std::vector<double> times;                        ///< s
  std::vector<RadarScan> scans() const;
};

/// Five planar mounts around a car, like those of nuScenes.
std::vector<Eigen::Isometry3d> carMounts();

/// A mount from position and yaw.
Eigen::Isometry3d mount(double x, double y, double z, double yaw, double pitch = 0.0);

/// Sweep of `mounts` on a body with velocity v (m/s) and angular velocity w (rad/s), base frame.
Sweep makeSweep(const std::vector<Eigen::Isometry3d>& mounts, const Eigen::Vector3d& v,
                const Eigen::Vector3d& w, const SweepOptions& options = {});

}  // namespace radar_dot::test
