// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/mask_footprint.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace radar_dot {
namespace {

constexpr float kNearest = 0.1F;  // m; what is nearer to the camera's plane has no useful pixel

/// Marked and visible pixels of a column.
struct ColumnCount {
  int visible = 0;
  int marked = 0;
};

/// Walks the column pixel by pixel.
ColumnCount countColumn(const Eigen::Vector2d& bottom, const Eigen::Vector2d& top, const cv::Mat& mask) {
  ColumnCount count;
  // Ends far outside of the image would make the walk long for nothing.
  const double reach = 4.0 * (mask.cols + mask.rows);
  if (!(bottom.cwiseAbs().maxCoeff() < reach && top.cwiseAbs().maxCoeff() < reach)) return count;
  const Eigen::Vector2d step = top - bottom;
  const int steps = std::max(1, static_cast<int>(std::ceil(step.cwiseAbs().maxCoeff())));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d place = bottom + step * (static_cast<double>(i) / steps);
    const auto column = static_cast<int>(std::lround(place.x()));
    const auto row = static_cast<int>(std::lround(place.y()));
    if (column < 0 || row < 0 || column >= mask.cols || row >= mask.rows) continue;
    ++count.visible;
    if (mask.at<std::uint8_t>(row, column) != 0) ++count.marked;
  }
  return count;
}

}  // namespace

void validate(const MaskFootprint& footprint) {
  const FieldList fields = fieldsOf(footprint);
  checkFields(fields);
  requireLess(fields, footprint.bottom, footprint.top);
}

std::vector<std::uint8_t> pointsInMask(const std::vector<Eigen::Vector3f>& points, const StampedMask& mask,
                                       const MaskFootprint& footprint) {
  const cv::Mat& pixels = mask.mask;
  const CameraIntrinsics& camera = mask.camera;
  if (pixels.type() != CV_8UC1 || pixels.cols != camera.width || pixels.rows != camera.height) {
    throw std::invalid_argument("mask: expected CV_8UC1 of " + std::to_string(camera.width) + " x " +
                                std::to_string(camera.height) + " px, the camera's grid");
  }
  std::vector<std::uint8_t> in_mask(points.size(), 0);
  const Eigen::Isometry3f T = mask.T_camera_from_base.cast<float>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const Eigen::Vector3f bottom =
        T * Eigen::Vector3f(points[i].x(), points[i].y(), static_cast<float>(footprint.bottom));
    const Eigen::Vector3f top =
        T * Eigen::Vector3f(points[i].x(), points[i].y(), static_cast<float>(footprint.top));
    if (bottom.z() < kNearest || top.z() < kNearest) continue;
    const ColumnCount count =
        countColumn(camera.project(bottom.cast<double>()), camera.project(top.cast<double>()), pixels);
    if (count.visible > 0 && count.marked >= footprint.min_fraction * count.visible) in_mask[i] = 1;
  }
  return in_mask;
}

}  // namespace radar_dot
