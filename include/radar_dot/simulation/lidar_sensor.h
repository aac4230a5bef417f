// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/sensor_mounts.h"
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {

/// A spinning lidar like the HDL-32E of the nuScenes car.
struct LidarModel {
  int beams = 32;
  double top_elevation = 0.1862;  ///< rad (10.67 degrees)
  double beam_step = 0.023271;    ///< rad (1.333 degrees)
  int azimuth_steps = 1084;       ///< per turn, at 20 turns a second
  double max_range = 100.0;       ///< m, of a white surface
  double min_range = 1.0;         ///< m
  double range_noise = 0.02;      ///< m, sigma
  double quantum = 0.002;         ///< m, step of the measured range
};

struct LidarReturn {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< m, sensor frame
  float intensity = 0.0F;                           ///< 0..255
  int ring = 0;                                     ///< 0 = lowest beam
  std::int32_t actor = -1;  ///< number in World::actors, -1 = static; not written to files
};

/// One turn, as if all rays were shot at the time of the snapshot: the files of nuScenes are used as if
/// they were, too. Same seed and stream: same returns.
std::vector<LidarReturn> simulateLidarSweep(const Snapshot& snapshot, const SensorMount& mount,
                                            const Trajectory& ego, const LidarModel& model,
                                            std::uint64_t seed, std::uint64_t stream);

}  // namespace radar_dot::simulation
