// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// Inverse depth of the plane z = height + slope x (base frame) along a ray, and its derivatives.
struct GroundRay {
  double rho = 0.0, by_slope = 0.0, by_height = 0.0;  // 1/m, per unit of slope, per m
};

/// @param u, v  px   @param height  m. rho is not positive at and above the horizon.
inline GroundRay groundRay(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                           double u, double v, double slope, double height) {
  const Eigen::Vector3d c = T_base_from_camera.translation();
  const Eigen::Vector3d d = T_base_from_camera.linear() * camera.rayOf(u, v);
  const double across = d.z() - slope * d.x();
  const double above = height + slope * c.x() - c.z();  // negative: the camera is above the ground
  return {across / above, -d.x() / above - across * c.x() / (above * above), -across / (above * above)};
}

}  // namespace radar_dot
