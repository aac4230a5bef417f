// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

namespace radar_dot {

/// A rectified pinhole camera: the paper's K, and the grid of pixels it belongs to. Camera frame: x right,
/// y down, z ahead. Whole pixel coordinates are centres of pixels, so the image spans -0.5 .. width - 0.5.
struct CameraIntrinsics {
  double fx = 0.0, fy = 0.0;  ///< px
  double cx = 0.0, cy = 0.0;  ///< px
  int width = 0, height = 0;  ///< px

  /// From the 3x3 matrix K (px). @throws std::invalid_argument for a focal length or a size that is not
  /// positive, or anything that is not finite.
  static CameraIntrinsics fromMatrix(const Eigen::Matrix3d& matrix, int width, int height);
  Eigen::Matrix3d matrix() const;

  /// The same camera on a grid of another size. The borders of the image stay where they are.
  CameraIntrinsics scaledTo(int new_width, int new_height) const;

  /// K^-1 (u, v, 1): the ray of a pixel, z = 1.
  Eigen::Vector3d rayOf(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
  /// Pixel of a point (m, camera frame), whose z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
};

/// Size of the grid that is `working_width` px wide, of the image's shape; the image's own size where that is
/// 0 or not smaller than the image. @param image  px
cv::Size workingGrid(const cv::Size& image, int working_width);

}  // namespace radar_dot
