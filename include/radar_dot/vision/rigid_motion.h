// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "radar_dot/common/base_motion.h"

namespace radar_dot {

/// The paper's T_{t-1 -> t}: takes a static point from the camera frame at t-1 to the camera frame at t. It
/// is the inverse of the camera's own motion, with the lever arm from the base to the camera:
///     T_current_from_previous = T_camera_from_base . inv(T_previous_from_current of the base) .
///     T_base_from_camera.
Eigen::Isometry3d staticPointMotion(const Eigen::Isometry3d& T_base_from_camera,
                                    const Eigen::Isometry3d& base_previous_from_current);

/// Covariance of a small motion (omega, tau), X -> X + omega x X + tau, of points in the base frame, as one
/// of the same points in the camera frame: omega turns with the mount, and acts on tau by the lever arm.
/// With the inverse of the mount it goes the other way. @param base  rad^2, rad m, m^2
Eigen::Matrix<double, 6, 6> cameraCovariance(const Eigen::Isometry3d& T_base_from_camera,
                                             const Eigen::Matrix<double, 6, 6>& base);

}  // namespace radar_dot
