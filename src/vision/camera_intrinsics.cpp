// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/camera_intrinsics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace radar_dot {

CameraIntrinsics CameraIntrinsics::fromMatrix(const Eigen::Matrix3d& matrix, int width, int height) {
  // Beyond these, products of them are no numbers.
  constexpr double kLeast = 1e-3, kMost = 1e6;
  if (!matrix.allFinite() || matrix.cwiseAbs().maxCoeff() > kMost || !(matrix(0, 0) >= kLeast) ||
      !(matrix(1, 1) >= kLeast)) {
    throw std::invalid_argument(
        fmt::format("camera matrix: the focal lengths are {} and {} px, the centre {}, {}; the lengths must "
                    "be at least {}, and all "
                    "of it finite and at most {}",
                    matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2), kLeast, kMost));
  }
  if (width <= 0 || height <= 0) {
    throw std::invalid_argument(
        fmt::format("camera: its image is {} x {} px; both must be positive", width, height));
  }
  return {matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2), width, height};
}

Eigen::Matrix3d CameraIntrinsics::matrix() const {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = fx;
  k(1, 1) = fy;
  k(0, 2) = cx;
  k(1, 2) = cy;
  return k;
}

CameraIntrinsics CameraIntrinsics::scaledTo(int new_width, int new_height) const {
  const double x = static_cast<double>(new_width) / width;
  const double y = static_cast<double>(new_height) / height;
  // The border of the image, half a pixel beyond the first centre, is what stays.
  return {fx * x, fy * y, (cx + 0.5) * x - 0.5, (cy + 0.5) * y - 0.5, new_width, new_height};
}

cv::Size workingGrid(const cv::Size& image, int working_width) {
  if (working_width <= 0 || working_width >= image.width) return image;
  const double height = static_cast<double>(image.height) * working_width / image.width;
  return {working_width, std::max(2, static_cast<int>(std::lround(height)))};
}

}  // namespace radar_dot
