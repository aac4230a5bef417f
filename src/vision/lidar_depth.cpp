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

/// Completion on inverse depth, where nearer is larger and 0 is unknown: a dilation lets the nearest surface
/// win.
class LidarDepth : public DepthEstimator {
 public:
  explicit LidarDepth(const DepthParams& params) : params_(params) {}

  cv::Mat estimate(const DepthInput& input) override {
    if (input.lidar_points.empty()) {
      throw std::invalid_argument(
          "depth 'lidar': there are no lidar points; is a lidar topic or LIDAR_TOP there?");
    }
    const cv::Mat sparse =
        projectedDepth(input.lidar_points, input.camera, input.T_base_from_camera, params_.max_depth);
    cv::Mat inverse(sparse.size(), CV_32FC1);
    for (int row = 0; row < sparse.rows; ++row) {
      for (int column = 0; column < sparse.cols; ++column) {
        const float d = sparse.at<float>(row, column);
        inverse.at<float>(row, column) = d > 0.0F ? 1.0F / d : 0.0F;
      }
    }
    // Gaps between the points of a beam first, then between beams: small steps keep edges where they are.
    const int largest =
        std::max(3, static_cast<int>(std::lround(params_.completion_kernel * sparse.cols / 1600.0)) | 1);
    fillHoles(inverse, 3);
    fillHoles(inverse, std::max(3, (largest / 2) | 1));
    fillHoles(inverse, largest);
    cv::Mat smooth;
    cv::medianBlur(inverse, smooth, 5);
    cv::Mat depth(sparse.size(), CV_32FC1);
    for (int row = 0; row < depth.rows; ++row) {
      for (int column = 0; column < depth.cols; ++column) {
        const float here = inverse.at<float>(row, column) > 0.0F ? smooth.at<float>(row, column) : 0.0F;
        depth.at<float>(row, column) = here > 0.0F ? 1.0F / here : std::numeric_limits<float>::quiet_NaN();
      }
    }
    return depth;
  }

 private:
  static void fillHoles(cv::Mat& inverse, int size) {
    cv::Mat filled;
    const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(size, size));
    cv::morphologyEx(inverse, filled, cv::MORPH_CLOSE, kernel);
    filled.copyTo(inverse, inverse == 0.0F);
  }

  DepthParams params_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeLidarDepth(const DepthParams& params) {
  return std::make_unique<LidarDepth>(params);
}

}  // namespace radar_dot
