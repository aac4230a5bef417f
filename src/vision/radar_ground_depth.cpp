// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "depth_backends.h"

namespace radar_dot {
namespace {

constexpr float kNearest = 0.5F;      // m; nearer is the vehicle itself
constexpr double kPriorWeight = 0.2;  // of the background without radar, in returns straight ahead

/// The column a return stands for, as the camera sees it.
struct Column {
  double u = 0.0;                  // px, its middle
  double half_width = 0.0;         // px
  double top = 0.0, bottom = 0.0;  // px
  float depth = 0.0F;              // m
};

class RadarGroundDepth : public DepthEstimator {
 public:
  explicit RadarGroundDepth(const DepthParams& params) : params_(params) {}

  cv::Mat estimate(const DepthInput& input) override {
    cv::Mat depth = groundDepth(input.camera, input.T_base_from_camera, params_.ground_height,
                                params_.ground_pitch, params_.max_depth);
    const std::vector<Column> columns = columnsOf(input);
    if (params_.background_depth > 0.0) fillBackground(input.camera, columns, depth);
    for (const Column& column : columns) draw(column, depth);
    return depth;
  }

 private:
  std::vector<Column> columnsOf(const DepthInput& input) const {
    const Eigen::Isometry3d T_camera_from_base = input.T_base_from_camera.inverse();
    const double slope = std::tan(params_.ground_pitch);
    std::vector<Column> columns;
    for (const Eigen::Vector3f& point : input.radar_points) {
      if (!point.allFinite()) continue;
      // A planar radar knows no height: the column stands on the ground.
      const double x = static_cast<double>(point.x());
      const double y = static_cast<double>(point.y());
      const double ground = params_.ground_height + slope * x;
      const Eigen::Vector3d foot = T_camera_from_base * Eigen::Vector3d(x, y, ground);
      const Eigen::Vector3d head = T_camera_from_base * Eigen::Vector3d(x, y, ground + params_.column_height);
      if (!(foot.z() > kNearest) || !(head.z() > kNearest) || foot.z() > params_.max_depth) continue;
      const Eigen::Vector2d bottom = input.camera.project(foot);
      const Eigen::Vector2d top = input.camera.project(head);
      const double half_width = std::max(params_.column_half_width, params_.azimuth_std * std::hypot(x, y));
      columns.push_back({bottom.x(), input.camera.fx * half_width / foot.z(), top.y(), bottom.y(),
                         static_cast<float>(foot.z())});
    }
    return columns;
  }

  /// What is neither ground nor column: somewhere behind the columns in its direction, on average not far.
  void fillBackground(const CameraIntrinsics& camera, const std::vector<Column>& columns,
                      cv::Mat& depth) const {
    const double reach = params_.background_angle * camera.fx;  // px
    std::vector<float> background(static_cast<std::size_t>(depth.cols));
    for (int u = 0; u < depth.cols; ++u) {
      double weight = kPriorWeight;
      double inverse = kPriorWeight / params_.background_depth;
      for (const Column& column : columns) {
        const double distance = (u - column.u) / reach;
        if (std::abs(distance) > 4.0) continue;
        const double w = std::exp(-0.5 * distance * distance);
        weight += w;
        inverse += w / static_cast<double>(column.depth);
      }
      background[static_cast<std::size_t>(u)] = static_cast<float>(weight / inverse);
    }
    for (int row = 0; row < depth.rows; ++row) {
      float* pixels = depth.ptr<float>(row);
      for (int u = 0; u < depth.cols; ++u)
        if (std::isnan(pixels[u])) pixels[u] = background[static_cast<std::size_t>(u)];
    }
  }

  static void draw(const Column& column, cv::Mat& depth) {
    const auto clamped = [](double value, int size) {
      return static_cast<int>(std::lround(std::clamp(value, 0.0, static_cast<double>(size))));
    };
    const int left = clamped(column.u - column.half_width, depth.cols);
    const int right = clamped(column.u + column.half_width + 1.0, depth.cols);
    const int top = clamped(column.top, depth.rows);
    const int bottom = clamped(column.bottom + 1.0, depth.rows);
    for (int row = top; row < bottom; ++row) {
      float* pixels = depth.ptr<float>(row);
      for (int u = left; u < right; ++u)
        if (!(pixels[u] <= column.depth)) pixels[u] = column.depth;  // also where nothing was known
    }
  }

  DepthParams params_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeRadarGroundDepth(const DepthParams& params) {
  return std::make_unique<RadarGroundDepth>(params);
}

}  // namespace radar_dot
