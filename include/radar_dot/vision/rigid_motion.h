// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace radar_dot {

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

/// Velocities of the base frame, in its own axes.
struct BaseVelocity {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s, of the origin
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s
};
/// The inverse of baseMotion: the constant velocity that makes this motion in `dt` s.
/// @throws std::invalid_argument for dt = 0
BaseVelocity baseVelocity(const Eigen::Isometry3d& base_previous_from_current, double dt);

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
