// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {

Eigen::Isometry3d staticPointMotion(const Eigen::Isometry3d& T_base_from_camera,
                                    const Eigen::Isometry3d& base_previous_from_current) {
  return T_base_from_camera.inverse() * base_previous_from_current.inverse() * T_base_from_camera;
}

Eigen::Matrix<double, 6, 6> cameraCovariance(const Eigen::Isometry3d& T_base_from_camera,
                                             const Eigen::Matrix<double, 6, 6>& base) {
  // X_base = R X + c, so that R^T (omega x X_base + tau) = (R^T omega) x X + R^T (omega x c + tau).
  const Eigen::Matrix3d R_camera_from_base = T_base_from_camera.linear().transpose();
  Eigen::Matrix<double, 6, 6> adjoint = Eigen::Matrix<double, 6, 6>::Zero();
  adjoint.topLeftCorner<3, 3>() = R_camera_from_base;
  adjoint.bottomRightCorner<3, 3>() = R_camera_from_base;
  for (int i = 0; i < 3; ++i) {
    adjoint.block<3, 1>(3, i) =
        R_camera_from_base * Eigen::Vector3d::Unit(i).cross(T_base_from_camera.translation());
  }
  return adjoint * base * adjoint.transpose();
}

}  // namespace radar_dot
