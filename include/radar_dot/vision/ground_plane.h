// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// How well the ground plane is known, 1 sigma.
struct GroundUncertainty {
  double pitch_std = 0.02;
  double height_std = 0.05;
  double relative_std = 0.1;

  void describe(FieldList& fields) {
    fields.add("ground_pitch_std", pitch_std, "1 sigma of the pitch of the ground ahead", "rad", {0.0, 0.5});
    fields.add("ground_height_std", height_std, "1 sigma of the height of the ground", "m", {0.0, 10.0});
    fields.add("ground_relative_std", relative_std,
               "1 sigma of the inverse depth of ground that is not flat, relative", "", {0.0, 10.0});
  }
};

/// The plane of the ground in the base frame.
struct GroundParams {
  double pitch = 0.0;   ///< rad, against the base frame's x-y plane, nose down positive
  double height = 0.0;  ///< m
  GroundUncertainty uncertainty;

  void describe(FieldList& fields) {
    fields.add("ground_pitch", pitch, "Pitch of the ground in the base frame, nose down positive", "rad",
               {-0.5, 0.5});
    fields.add("ground_height", height, "Height of the ground in the base frame", "m", {-10.0, 10.0});
    uncertainty.describe(fields);
  }
};

/// The ground plane that a part of MotionInput::depth shows (groundDepth), and how well it is known. The
/// relative error of its depth overrides MotionInput::depth_std; pitch and height are separate because they
/// are estimated.
struct GroundPlane {
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();  ///< at t-1
  GroundParams params;
};

/// Depth of the ground plane (z = height in the base frame, turned by pitch about the base's y axis): NaN at
/// and above the horizon and beyond max_depth.
cv::Mat groundDepth(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                    double height, double pitch, double max_depth);

/// 1 sigma of the inverse depth rho of the ground plane relative to it, CV_32FC1: NaN at and above the
/// horizon.
///
/// With h the height of the camera above the plane straight below it, c_x the camera's place ahead of the
/// base frame's origin, d the ray of a pixel in the base frame (1 m along the optical axis) and s =
/// tan(pitch),
///     rho = (s d_x - d_z) / h,    drho/dheight = rho / h,
///     drho/dpitch = (1 + s^2) (d_x + rho c_x) / h.
/// So the share that the height adds is the same everywhere, height_std / h; that of the pitch grows with the
/// distance ahead, about distance / h. Both and relative_std are independent of each other.
cv::Mat groundRelativeStd(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                          const GroundParams& ground);

/// m, of the ground at two sigmas: nothing that stands on it is farther. NaN at and above the horizon.
cv::Mat farthestGround(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                       const GroundParams& ground);

}  // namespace radar_dot
