// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/just_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "radar_dot/vision/network_images.h"

namespace radar_dot::just_depth {
namespace {

// Of ImageNet, red, green, blue, in shares of full brightness.
constexpr std::array<double, 3> kMean = {0.485, 0.456, 0.406};
constexpr std::array<double, 3> kDeviation = {0.229, 0.224, 0.225};

}  // namespace

void imagePlanes(const cv::Mat& image, cv::Mat& planes) {
  if (image.empty() || (image.type() != CV_8UC3 && image.type() != CV_8UC1))
    throw std::invalid_argument("JustDepth: the image must be CV_8UC3 (BGR) or CV_8UC1, and not empty");
  const cv::Mat seen = resizedImage(image, cv::Size(kWidth, kHeight)).rowRange(kCut, kHeight);
  std::array<double, 3> factor{}, offset{};
  for (std::size_t c = 0; c < 3; ++c) {
    factor[c] = 1.0 / (255.0 * kDeviation[c]);
    offset[c] = -kMean[c] / kDeviation[c];
  }
  colourPlanes(seen, factor, offset, planes);
}

std::vector<float> radarColumns(const std::vector<Eigen::Vector3f>& points_base,
                                const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera) {
  const CameraIntrinsics full = camera.scaledTo(kWidth, kHeight);
  const Eigen::Isometry3d T_camera_from_base = T_base_from_camera.inverse();
  std::vector<float> columns(static_cast<std::size_t>(kWidth), 0.0F);
  for (const Eigen::Vector3f& point : points_base) {
    const Eigen::Vector3d seen = T_camera_from_base * point.cast<double>();
    if (!(seen.z() > 0.0)) continue;
    const Eigen::Vector2d pixel = full.project(seen);
    if (!(pixel.x() > 0.0 && pixel.x() < kWidth && pixel.y() > 0.0 && pixel.y() < kHeight)) continue;
    float& nearest = columns[static_cast<std::size_t>(pixel.x())];
    const auto depth = static_cast<float>(seen.z());
    if (nearest == 0.0F || depth < nearest) nearest = depth;
  }
  return columns;
}

cv::Mat onGrid(const cv::Mat& output, const cv::Size& grid) {
  if (output.type() != CV_32FC1 || output.size() != cv::Size(kWidth, kRows)) {
    throw std::invalid_argument(
        fmt::format("JustDepth: the output must be CV_32FC1 of {} x {} px", kWidth, kRows));
  }
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  cv::Mat full(kHeight, kWidth, CV_32FC1);
  full.rowRange(0, kCut).setTo(kUnknown);
  for (int row = 0; row < kRows; ++row) {
    const float* from = output.ptr<float>(row);
    float* to = full.ptr<float>(row + kCut);
    for (int column = 0; column < kWidth; ++column)
      to[column] = std::isfinite(from[column]) ? std::max(from[column], 0.0F) : kUnknown;
  }
  if (grid == full.size()) return full;
  cv::Mat depth;
  // Nearest: between an object and what is behind it there is nothing.
  cv::resize(full, depth, grid, 0.0, 0.0, cv::INTER_NEAREST);
  return depth;
}

}  // namespace radar_dot::just_depth
