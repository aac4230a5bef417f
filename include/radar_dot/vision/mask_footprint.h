// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// What a radar return stands for in an image. Most automotive radars do not measure elevation: a return is
/// an upright column at its place.
struct MaskFootprint {
  double bottom = 0.3;
  double top = 1.3;
  double min_fraction = 0.5;

  void describe(FieldList& fields) {
    fields.add("mask_bottom", bottom, "Lower end of the column that a return stands for, in the base frame",
               "m", {-10.0, 10.0});
    fields.add("mask_top", top, "Upper end of the column", "m", {-10.0, 10.0});
    fields.add("mask_min_fraction", min_fraction,
               "Fraction of the pixels of the column within the image that must be marked", "", {0.0, 1.0});
  }
};
/// @throws InvalidParameter, also for ends in the wrong order
void validate(const MaskFootprint& footprint);

/// A mask, and its camera.
struct StampedMask {
  double time = 0.0;  ///< s, of its image
  cv::Mat mask;       ///< CV_8UC1 on the grid of `camera`, not 0 = marked
  CameraIntrinsics camera;
  Eigen::Isometry3d T_camera_from_base = Eigen::Isometry3d::Identity();
};

/// Which points lie on what a mask marks: the image's half of the loop between mask and velocity.
/// @param points  m, base frame, at the time of the mask; those that are not finite, behind the camera or out
///                of its view are not in the mask
/// @return one value per point: 1 = in the mask, 0 = not
/// @throws std::invalid_argument for a mask of another type or size than the camera's grid
std::vector<std::uint8_t> pointsInMask(const std::vector<Eigen::Vector3f>& points, const StampedMask& mask,
                                       const MaskFootprint& footprint = {});

}  // namespace radar_dot
