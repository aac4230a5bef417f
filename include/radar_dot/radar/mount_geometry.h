// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// What the mounts of the radars let one sweep tell, from their geometry alone.
struct MountGeometry {
  double vx_std = 0.0, vy_std = 0.0;  ///< m/s, 1 sigma; infinite where the mounts do not determine it
  double yaw_rate_std = 0.0;          ///< rad/s; infinite for a model without a yaw rate
  std::string advice;                 ///< what another model would do better, and why; empty: the model suits
};

/// Every radar is taken to see static returns all over its field of view.
/// @param half_field_of_view  rad, azimuth
/// @param params              model, noise, scan_std (an error that returns of a scan share), sideslip_std
MountGeometry assessMounts(const std::vector<Eigen::Isometry3d>& T_base_from_sensor,
                           const EgoVelocityParams& params, double half_field_of_view = 1.05);

}  // namespace radar_dot
