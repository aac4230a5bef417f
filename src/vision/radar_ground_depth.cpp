// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "depth_backends.h"
#include "radar_dot/vision/return_reach.h"

namespace radar_dot {
namespace {

constexpr float kNearest = 0.5F;      // m; nearer is the vehicle itself
constexpr double kPriorWeight = 0.2;  // of the background without radar, in returns straight ahead

/// The column a return stands for, as the camera sees it.
struct Column {
  double u = 0.0;                  // px, its bearing
  double left = 0.0, right = 0.0;  // px
  double top = 0.0, bottom = 0.0;  // px
  float depth = 0.0F;              // m
};

/// Moves the borders of columns to where the image changes, as far as that is likely.
class ColumnEdges {
 public:
  ColumnEdges(const cv::Mat& image, const cv::Size& size) {
    if (image.type() != CV_8UC3 && image.type() != CV_8UC1) {
      throw std::invalid_argument(
          "depth 'radar_ground': the image must be CV_8UC3 or CV_8UC1, or left out, or image_edges be off");
    }
    cv::Mat grey;
    cv::resize(image, grey, size, 0.0, 0.0, cv::INTER_AREA);
    if (grey.channels() == 3) cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
    sideways_ = summedChange(grey, 1, 0);
    downwards_ = summedChange(grey, 0, 1);
  }

  Column bounded(const Column& column) const {
    const double height = column.bottom - column.top;
    // Low enough for a car, and clear of the change where the column meets the ground.
    const cv::Point body(static_cast<int>(std::lround(column.bottom - 0.8 * height)),
                         static_cast<int>(std::lround(column.bottom - 0.1 * height)));
    const auto side = [&](double border) {
      const double half_width = border - column.u;
      const double factor = best(std::abs(half_width), {0.4, 1.6}, kWidthSpread, [&](double f) {
        const int u = static_cast<int>(std::lround(column.u + f * half_width));
        return mean(sideways_, u, body.x, u + 1, body.y);
      });
      return column.u + factor * half_width;
    };
    Column result = column;
    result.left = side(column.left);
    result.right = side(column.right);
    const int inner_left = static_cast<int>(std::lround(0.85 * result.left + 0.15 * result.right));
    const int inner_right = static_cast<int>(std::lround(0.15 * result.left + 0.85 * result.right)) + 1;
    const double factor = best(height, {0.6, 2.0}, kHeightSpread, [&](double f) {
      const int v = static_cast<int>(std::lround(column.bottom - f * height));
      return mean(downwards_, inner_left, v, inner_right, v + 1);
    });
    result.top = column.bottom - factor * height;
    return result;
  }

 private:
  static constexpr double kWidthSpread = 0.4;   // 1 sigma of the width over the expected one
  static constexpr double kHeightSpread = 0.5;  // of the height
  static constexpr double kFlatImage = 10.0;    // grey values per px; less than this hardly counts

  struct Range {
    double from = 0.0, to = 0.0;
  };

  /// Sums of the change along (dx, dy), so that the mean over any box costs four look-ups.
  static cv::Mat summedChange(const cv::Mat& grey, int dx, int dy) {
    cv::Mat change, sums;
    cv::Sobel(grey, change, CV_16S, dx, dy, 3);
    cv::convertScaleAbs(change, change, 0.25);
    cv::integral(change, sums, CV_32S);
    return sums;
  }

  /// Over the box as far as it is in the image.
  static double mean(const cv::Mat& sums, int left, int top, int right, int bottom) {
    left = std::max(left, 0);
    top = std::max(top, 0);
    right = std::min(right, sums.cols - 1);
    bottom = std::min(bottom, sums.rows - 1);
    if (left >= right || top >= bottom) return 0.0;
    const int sum = sums.at<int>(bottom, right) - sums.at<int>(top, right) - sums.at<int>(bottom, left) +
                    sums.at<int>(top, left);
    return sum / (static_cast<double>(right - left) * (bottom - top));
  }

  /// The factor on a length of `pixels` where the image changes most, factors near 1 preferred.
  template <typename Change>
  static double best(double pixels, const Range& range, double spread, const Change& change) {
    const double step = std::clamp(1.0 / std::max(pixels, 1.0), 0.005, 0.5);
    double best_factor = 1.0;
    double best_score = kFlatImage + change(1.0);
    for (double factor = range.from; factor <= range.to; factor += step) {
      const double off = (factor - 1.0) / spread;
      const double score = (kFlatImage + change(factor)) * std::exp(-0.5 * off * off);
      if (score > best_score) {
        best_score = score;
        best_factor = factor;
      }
    }
    return best_factor;
  }

  cv::Mat sideways_, downwards_;
};

class RadarGroundDepth : public DepthEstimator {
 public:
  explicit RadarGroundDepth(const DepthParams& params) : params_(params) {}

  DepthNeeds needs() const override { return {params_.radar_ground.image_edges, true, false}; }

  cv::Mat estimate(const DepthInput& input) override { return drawn(input, false).depth; }

  cv::Mat relativeStd(const DepthInput& input, const cv::Mat& depth) const override {
    cv::Mat stds = drawn(input, true).stds;
    if (depth.type() != CV_32FC1 || depth.size() != stds.size())
      throw std::invalid_argument(
          "depth 'radar_ground': the depth must be CV_32FC1 on the grid of the camera");
    stds.setTo(std::numeric_limits<double>::quiet_NaN(), ~(depth == depth));
    return stds;
  }

 private:
  /// What is seen of ground, background and columns.
  struct Layers {
    cv::Mat depth;  // m
    cv::Mat stds;   // of the inverse depth, relative; empty where they are not wanted

    /// One pixel of a surface with this depth, where nothing nearer is known.
    struct Row {
      float* depths;
      float* stds;
      void show(int u, float metres, float relative_std) const {
        if (depths[u] <= metres) return;  // false where nothing was known
        depths[u] = metres;
        if (stds != nullptr) stds[u] = relative_std;
      }
    };
    Row row(int v) { return {depth.ptr<float>(v), stds.empty() ? nullptr : stds.ptr<float>(v)}; }
  };

  Layers drawn(const DepthInput& input, bool with_stds) const {
    Layers layers;
    layers.depth = groundDepth(input.camera, input.T_base_from_camera, params_.radar_ground.ground.height,
                               params_.radar_ground.ground.pitch, params_.max_depth);
    if (with_stds) {
      layers.stds = groundRelativeStd(input.camera, input.T_base_from_camera, params_.radar_ground.ground);
    }
    std::vector<Column> columns = columnsOf(input);
    if (params_.radar_ground.image_edges && !input.image.empty()) {
      const ColumnEdges edges(input.image, layers.depth.size());
      for (Column& column : columns) column = edges.bounded(column);
    }
    if (params_.radar_ground.background_depth > 0.0) fillBackground(input.camera, columns, layers);
    for (const Column& column : columns) draw(column, layers);
    return layers;
  }

  std::vector<Column> columnsOf(const DepthInput& input) const {
    const Eigen::Isometry3d T_camera_from_base = input.T_base_from_camera.inverse();
    const double slope = std::tan(params_.radar_ground.ground.pitch);
    std::vector<Eigen::Vector2f> places;
    for (const Eigen::Vector3f& point : input.radar_points) places.emplace_back(point.head<2>());
    const std::vector<float> reaches =
        reachesOf(places, static_cast<float>(params_.radar_ground.column_half_width));
    std::vector<Column> columns;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Eigen::Vector3f& point = input.radar_points[i];
      if (!point.allFinite()) continue;
      // A planar radar knows no height: the column stands on the ground.
      const double x = static_cast<double>(point.x());
      const double y = static_cast<double>(point.y());
      const double ground = params_.radar_ground.ground.height + slope * x;
      const Eigen::Vector3d foot = T_camera_from_base * Eigen::Vector3d(x, y, ground);
      const Eigen::Vector3d head =
          T_camera_from_base * Eigen::Vector3d(x, y, ground + params_.radar_ground.column_height);
      if (!(foot.z() > kNearest) || !(head.z() > kNearest) || foot.z() > params_.max_depth) continue;
      const Eigen::Vector2d bottom = input.camera.project(foot);
      const Eigen::Vector2d top = input.camera.project(head);
      const double half_width =
          std::max(static_cast<double>(reaches[i]), params_.radar_ground.azimuth_std * std::hypot(x, y));
      const double half_pixels = input.camera.fx * half_width / foot.z();
      columns.push_back({bottom.x(), bottom.x() - half_pixels, bottom.x() + half_pixels, top.y(), bottom.y(),
                         static_cast<float>(foot.z())});
    }
    return columns;
  }

  /// What is neither ground nor column: somewhere behind the columns in its direction, on average not far. It
  /// hides the ground farther away.
  void fillBackground(const CameraIntrinsics& camera, const std::vector<Column>& columns,
                      Layers& layers) const {
    const cv::Mat& depth = layers.depth;
    const double reach = params_.radar_ground.background_angle * camera.fx;  // px
    std::vector<float> background(static_cast<std::size_t>(depth.cols));
    for (int u = 0; u < depth.cols; ++u) {
      double weight = kPriorWeight;
      double inverse = kPriorWeight / params_.radar_ground.background_depth;
      for (const Column& column : columns) {
        const double distance = (u - column.u) / reach;
        if (std::abs(distance) > 4.0) continue;
        const double w = std::exp(-0.5 * distance * distance);
        weight += w;
        inverse += w / static_cast<double>(column.depth);
      }
      background[static_cast<std::size_t>(u)] = static_cast<float>(weight / inverse);
    }
    const auto relative_std = static_cast<float>(params_.radar_ground.background_std);
    for (int row = 0; row < depth.rows; ++row) {
      const Layers::Row pixels = layers.row(row);
      for (int u = 0; u < depth.cols; ++u)
        pixels.show(u, background[static_cast<std::size_t>(u)], relative_std);
    }
  }

  void draw(const Column& column, Layers& layers) const {
    const cv::Mat& depth = layers.depth;
    const auto clamped = [](double value, int size) {
      return static_cast<int>(std::lround(std::clamp(value, 0.0, static_cast<double>(size))));
    };
    const int left = clamped(column.left, depth.cols);
    const int right = clamped(column.right + 1.0, depth.cols);
    const int top = clamped(column.top, depth.rows);
    const int bottom = clamped(column.bottom + 1.0, depth.rows);
    const auto relative_std = static_cast<float>(params_.radar_ground.column_std);
    for (int row = top; row < bottom; ++row) {
      const Layers::Row pixels = layers.row(row);
      for (int u = left; u < right; ++u) pixels.show(u, column.depth, relative_std);
    }
  }

  DepthParams params_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeRadarGroundDepth(const DepthParams& params) {
  return std::make_unique<RadarGroundDepth>(params);
}

}  // namespace radar_dot
