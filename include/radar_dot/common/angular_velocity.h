// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace radar_dot {

/// Angular velocity of the base frame, in the base frame.
struct AngularVelocity {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();        ///< rad/s
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< (rad/s)^2
};

}  // namespace radar_dot
