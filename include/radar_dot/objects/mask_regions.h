// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/objects/object_detection.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// Parameters of regionsOfMask.
struct MaskRegionParams {
  std::size_t min_pixels = 50;
  double pixel_std = 3.0;
  double relative_depth_std = 0.15;
  double flow_std = 1.0;

  void describe(FieldList& fields) {
    fields.add("min_pixels", min_pixels, "Regions of the mask with fewer pixels are ignored",
               "px of the grid", {1, 1e9});
    fields.add("pixel_std", pixel_std,
               "Lower limit of the 1 sigma of the object's axis within its region of the mask", "px",
               {0.01, 1000.0});
    fields.add("relative_depth_std", relative_depth_std, "1 sigma of the depth of a region, relative", "",
               {0.001, 10.0});
    fields.add("region_flow_std", flow_std, "1 sigma of the median flow residual of a region", "px",
               {0.001, 1000.0});
  }
};

/// The connected regions (8 neighbours) of a mask of moving pixels, as input of detectObjects.
///
/// A point at X = Z ray(u, v) in the camera frame that moves over ground with V shifts its pixel, beyond the
/// shift of a static point, in the time dt by
///     du = fx dt (V_x - (u - cx)/fx V_z) / Z,
/// to first order in dt. In the base frame, with the axes of the camera there, this is one constraint on the
/// planar velocity: that across the ray. It holds with the variance
///     flow_std^2 + (relative_depth_std du)^2   (px^2),
/// scaled to m/s. The velocity along the ray moves no pixel.
///
/// @param mask           CV_8UC1 on the grid of `camera`, not 0 = moves
/// @param depth          CV_32FC1, m, the same grid; NaN = unknown. A region without any depth is left out.
/// @param flow_residual  CV_32FC2, px over `interval`: measured minus expected flow; NaN = unknown.
///                       A region without any flow has a place, but its velocity is unknown.
/// @param interval       s, of the pair of images, positive
/// @throws std::invalid_argument for images of other types or sizes, and an interval that is not positive
std::vector<MaskRegion> regionsOfMask(const cv::Mat& mask, const cv::Mat& depth, const cv::Mat& flow_residual,
                                      double interval, const CameraIntrinsics& camera,
                                      const Eigen::Isometry3d& T_base_from_camera,
                                      const MaskRegionParams& params = {});

}  // namespace radar_dot
