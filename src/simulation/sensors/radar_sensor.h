// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "radar_dot/dataset/point_files.h"
#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/sensor_mounts.h"
#include "radar_dot/simulation/trajectory.h"
#include "simulation/sensors/radar_model.h"

namespace radar_dot::simulation {

/// One return as the radar reports it, and what no radar tells: for tests and calibration, not written to
/// files.
struct RadarReturn : dataset::RadarRecord {
  std::int32_t object = -1;      ///< number in Snapshot::objects of a real target; -1 = ghost or clutter
  float true_range_rate = 0.0F;  ///< m/s, of the surface point that reflects, without noise
};

/// Simulates one scan of one radar at the time of the snapshot. Returns are ordered as in real files: those
/// of the wide scan by range, then those of the narrow scan by range, at most 125, ids counted from 0.
/// Same seed and stream: same returns; give every scan a stream of its own.
/// @param ego motion of base_link.
std::vector<RadarReturn> simulateRadarScan(const Snapshot& snapshot, const SensorMount& mount,
                                           const Trajectory& ego, std::uint64_t seed, std::uint64_t stream,
                                           const RadarModel& model = RadarModel());

}  // namespace radar_dot::simulation
