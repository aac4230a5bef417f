// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "constraint_system.h"
#include "radar_dot/radar/motion_model.h"

namespace radar_dot {

/// Where the parameters of each model stand in vx vy vz wx wy wz.
struct ModelAxes {
  int count;
  std::array<int, 3> axes;
};

ModelAxes axesOf(MotionModel model) noexcept;

/// Moves a solution along the free directions (the columns of `basis` from `rank`) to the member of its
/// family with the least sideslip and vertical velocity (and, after them, the least forward velocity
/// and yaw rate). The returns cannot tell the members apart; a vehicle on wheels is most likely near
/// this one.
Parameters leastSideslipMember(const ModelAxes& model, const Eigen::Matrix3d& basis, int rank,
                           const Parameters& solution);

/// The basis with small components of its free directions set to zero. A radar a centimetre beside
/// the centre line leaves vx free by a hundredth of the yaw rate, which is no news; with the variance
/// of a free direction it would still pass for unobserved.
Eigen::Matrix3d removeTrails(Eigen::Matrix3d basis, int rank, int parameters);

}  // namespace radar_dot
