// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_terms.h"

#include <fmt/format.h>

#include <stdexcept>

#include "motion_images.h"
#include "parallel_rows.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

namespace motion_terms {

PixelMotion::PixelMotion(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous) {
  const Eigen::Matrix3d k = camera.matrix();
  const Eigen::Matrix3d homography = k * T_current_from_previous.linear() * k.inverse();
  const Eigen::Vector3d shift = k * T_current_from_previous.translation();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) H[i][j] = static_cast<float>(homography(i, j));
    h[i] = static_cast<float>(shift(i));
  }
}

std::optional<Eigen::Vector2d> focusOfExpansion(const CameraIntrinsics& camera,
                                                const Eigen::Vector3d& translation) {
  constexpr double kLeast = 0.01;  // m along the axis; less is standing, and its direction noise
  if (!(std::abs(translation.z()) >= kLeast)) return std::nullopt;
  return camera.project(translation);
}

}  // namespace motion_terms

void requireImage(const cv::Mat& image, int type, const CameraIntrinsics& camera, const char* name,
                  const char* type_name) {
  if (image.type() != type) {
    throw std::invalid_argument(fmt::format("motion segmentation: {} must be {}", name, type_name));
  }
  if (image.cols != camera.width || image.rows != camera.height) {
    throw std::invalid_argument(
        fmt::format("motion segmentation: {} is {} x {} px, the grid of the camera {} x {}", name, image.cols,
                    image.rows, camera.width, camera.height));
  }
}

cv::Mat expectedFlow(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous,
                     const cv::Mat& depth) {
  requireImage(depth, CV_32FC1, camera, "depth", "CV_32FC1");
  const motion_terms::PixelMotion motion(camera, T_current_from_previous);
  cv::Mat flow(depth.size(), CV_32FC2);
  parallelRows(depth.rows, [&](int row) {
    const float* depths = depth.ptr<float>(row);
    auto* flows = flow.ptr<cv::Vec2f>(row);
    for (int column = 0; column < depth.cols; ++column) {
      const auto u = static_cast<float>(column);
      const auto v = static_cast<float>(row);
      const motion_terms::Prediction predicted = motion_terms::predict(motion, u, v, depths[column]);
      const bool known = depths[column] > 0.0F && predicted.depth > 0.0F && std::isfinite(depths[column]);
      flows[column] = known ? cv::Vec2f(predicted.u - u, predicted.v - v) : cv::Vec2f(kNaN, kNaN);
    }
  });
  return flow;
}

}  // namespace radar_dot
