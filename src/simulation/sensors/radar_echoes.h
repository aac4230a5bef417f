// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/sensor_mounts.h"
#include "radar_dot/simulation/trajectory.h"
#include "simulation/sensors/radar_model.h"

namespace radar_dot::simulation {

/// Where a radar is and how it moves.
struct RadarMotion {
  Eigen::Isometry3d T_map_from_sensor = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, of the radar itself, map frame
  bool sideways = false;                               ///< it looks to a side of the car
  double yaw_rate = 0.0;                               ///< rad/s

  RadarMotion(const SensorMount& mount, const Trajectory& ego, double time_s);
  /// Range rate of something static, m/s, at an azimuth in the sensor's plane.
  double staticRangeRate(double azimuth) const;
};

/// What comes back from one place.
struct Echo {
  double range = 0.0;        ///< m
  double azimuth = 0.0;      ///< rad, sensor frame, before errors
  double rcs = 0.0;          ///< dBsm
  double range_rate = 0.0;   ///< m/s
  std::int32_t object = -1;  ///< number in Snapshot::objects, -1 for a ghost
  bool isolated = true;      ///< no stronger echo beside it
};

/// Smallest cross-section that the radar detects there, dBsm.
double detectionThreshold(double range, double azimuth, const RadarScanModel& scan, const RadarModel& model);

/// Echoes of surfaces that one scan detects, one per resolution cell, sorted by falling strength.
std::vector<Echo> surfaceEchoes(const Snapshot& snapshot, const RadarMotion& motion,
                                const RadarScanModel& scan, const RadarModel& model, RandomStream& random);

/// Adds what no surface is responsible for: multipath copies of echoes and clutter.
void addGhosts(std::vector<Echo>& echoes, const RadarMotion& motion, const RadarScanModel& scan,
               const RadarModel& model, RandomStream& random);

}  // namespace radar_dot::simulation
