// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "radar_dot/simulation/ray_tracing.h"
#include "simulation/sensors/radar_model.h"

namespace radar_dot::simulation {

/// Radar cross-section of what a cell of the radar holds around a hit, dBsm, without the fluctuation
/// between scans. Spots of a surface differ, and keep their strength from scan to scan.
double radarCrossSection(const Snapshot& snapshot, const Hit& hit, const Eigen::Vector3f& direction,
                         const Eigen::Vector3d& point, const RadarModel& model);

/// dB lost on the way through a surface and back; negative if nothing passes.
double radarTransmissionLoss(Material material);

}  // namespace radar_dot::simulation
