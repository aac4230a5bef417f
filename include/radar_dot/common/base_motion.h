// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "radar_dot/common/stamped_twist.h"

namespace radar_dot {

/// The rotation by a vector: about its direction, by its length in rad.
Eigen::Quaterniond rotationOf(const Eigen::Vector3d& rotation_vector);

/// Motion of the base frame over `dt` seconds at a constant velocity in its own frame.
/// @param linear   m/s, of the base origin, base frame (the paper's v_ego)
/// @param R_previous_from_current  rotation of the base over the interval; its angular velocity is taken
///                 as constant, so that the path is an arc. Without rotation the translation is v dt, as in
///                 the paper.
/// @return T_previous_from_current: pose of the base at the end of the interval, in its frame at the start
Eigen::Isometry3d baseMotionWithRotation(const Eigen::Vector3d& linear,
                                         const Eigen::Matrix3d& R_previous_from_current, double dt);

/// The same with an angular velocity (rad/s, base frame) instead of a rotation.
Eigen::Isometry3d baseMotion(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular, double dt);

/// The inverse of baseMotion: the constant velocity that makes this motion in `dt` s, without a time.
/// @throws std::invalid_argument for dt = 0
StampedTwist baseVelocity(const Eigen::Isometry3d& base_previous_from_current, double dt);

}  // namespace radar_dot
