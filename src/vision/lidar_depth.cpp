// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "depth_backends.h"

namespace radar_dot {
namespace {

constexpr float kSameSurface = 1.5F;    // ratio of depths up to which a gap is bridged by a plane
constexpr double kImageWidth = 1600.0;  // px, that pixel sizes are given at
constexpr double kBeamStep = 12.0;      // px at that width, a little more than between points of one beam
constexpr double kSkyGap = 8.0;         // px at that width, filled above the highest point of a column

/// Odd number of pixels on a grid of this width.
int oddPixels(double pixels, int width) {
  return static_cast<int>(std::lround(pixels * width / kImageWidth)) | 1;
}

/// Depth to inverse depth, where nearer is larger and 0 is unknown: a dilation lets the nearest surface win,
/// and planes are linear.
cv::Mat inverseOf(const cv::Mat& depth) {
  cv::Mat inverse(depth.size(), CV_32FC1);
  for (int row = 0; row < depth.rows; ++row) {
    const float* from = depth.ptr<float>(row);
    float* to = inverse.ptr<float>(row);
    for (int column = 0; column < depth.cols; ++column)
      to[column] = from[column] > 0.0F ? 1.0F / from[column] : 0.0F;
  }
  return inverse;
}

/// Fills the unknown within half of `size` of a point with the nearest surface there.
void spread(cv::Mat& inverse, const cv::Size& size) {
  cv::Mat spread;
  cv::dilate(inverse, spread, cv::getStructuringElement(cv::MORPH_RECT, size));
  spread.copyTo(inverse, inverse == 0.0F);
}

/// Closes the gaps of up to `largest` px between known pixels of each row: a plane where both ends can be of
/// one, else a step in the middle.
void bridgeRows(cv::Mat& inverse, int largest) {
  for (int row = 0; row < inverse.rows; ++row) {
    float* pixels = inverse.ptr<float>(row);
    int last = -1;
    for (int column = 0; column < inverse.cols; ++column) {
      if (!(pixels[column] > 0.0F)) continue;
      const int gap = column - last;
      if (last >= 0 && gap > 1 && gap <= largest) {
        const float begin = pixels[last];
        const float end = pixels[column];
        const bool plane = std::max(begin, end) <= kSameSurface * std::min(begin, end);
        for (int i = 1; i < gap; ++i) {
          const float part = static_cast<float>(i) / static_cast<float>(gap);
          pixels[last + i] = plane ? begin + part * (end - begin) : (part < 0.5F ? begin : end);
        }
      }
      last = column;
    }
  }
}

void bridgeColumns(cv::Mat& inverse, int largest) {
  cv::Mat turned;
  cv::transpose(inverse, turned);
  bridgeRows(turned, largest);
  cv::transpose(turned, inverse);
}

/// Projects a sweep and closes the gaps between its points, small ones first, so that edges stay where they
/// are.
class LidarDepth : public DepthEstimator {
 public:
  explicit LidarDepth(const DepthParams& params) : params_(params) {}

  DepthNeeds needs() const override { return {false, false, true}; }

  cv::Mat estimate(const DepthInput& input) override {
    if (input.lidar_points.empty()) {
      throw std::invalid_argument(
          "depth 'lidar': there are no lidar points; is a lidar topic or LIDAR_TOP there?");
    }
    cv::Mat inverse = inverseOf(
        projectedDepth(input.lidar_points, input.camera, input.T_base_from_camera, params_.max_depth));
    const int width = inverse.cols;
    const int largest = std::max(3, oddPixels(params_.lidar.completion_kernel, width));
    // Along the beam first, whose points are close; then from beam to beam.
    spread(inverse, cv::Size(std::min(largest, oddPixels(kBeamStep, width)), 3));
    bridgeColumns(inverse, largest);
    bridgeRows(inverse, largest);
    spread(inverse, cv::Size(1, std::min(largest, oddPixels(kSkyGap, width))));
    return smoothed(inverse);
  }

  cv::Mat relativeStd(const DepthInput& input, const cv::Mat& depth) const override {
    if (depth.type() != CV_32FC1 || depth.size() != cv::Size(input.camera.width, input.camera.height))
      throw std::invalid_argument("depth 'lidar': the depth must be CV_32FC1 on the grid of the camera");
    const cv::Mat points =
        projectedDepth(input.lidar_points, input.camera, input.T_base_from_camera, params_.max_depth);
    cv::Mat distance;  // px, to the nearest point; no point: far
    cv::distanceTransform(~(points == points), distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    const auto at_point = static_cast<float>(params_.lidar.point_std);
    const auto per_pixel = static_cast<float>(params_.lidar.completion_std * kImageWidth / depth.cols);
    cv::Mat stds = constantStd(depth, 0.0);
    for (int row = 0; row < depth.rows; ++row) {
      const float* apart = distance.ptr<float>(row);
      float* to = stds.ptr<float>(row);
      for (int column = 0; column < depth.cols; ++column)
        to[column] += std::hypot(at_point, per_pixel * apart[column]);
    }
    return stds;
  }

 private:
  /// The median keeps edges, and removes outliers; the unknown stays unknown.
  static cv::Mat smoothed(const cv::Mat& inverse) {
    cv::Mat smooth;
    cv::medianBlur(inverse, smooth, 5);
    cv::Mat depth(inverse.size(), CV_32FC1);
    for (int row = 0; row < depth.rows; ++row) {
      const float* raw = inverse.ptr<float>(row);
      const float* median = smooth.ptr<float>(row);
      float* to = depth.ptr<float>(row);
      for (int column = 0; column < depth.cols; ++column) {
        const float here = median[column] > 0.0F ? median[column] : raw[column];
        to[column] = raw[column] > 0.0F ? 1.0F / here : std::numeric_limits<float>::quiet_NaN();
      }
    }
    return depth;
  }

  DepthParams params_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeLidarDepth(const DepthParams& params) {
  return std::make_unique<LidarDepth>(params);
}

}  // namespace radar_dot
