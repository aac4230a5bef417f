// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "warp.h"

#include <opencv2/imgproc.hpp>

namespace radar_dot {

cv::Mat warpedBack(const cv::Mat& image, const cv::Mat& flow) {
  cv::Mat targets(flow.size(), CV_32FC2);
  for (int row = 0; row < flow.rows; ++row) {
    const auto* vectors = flow.ptr<cv::Vec2f>(row);
    auto* to = targets.ptr<cv::Vec2f>(row);
    for (int column = 0; column < flow.cols; ++column)
      to[column] = vectors[column] + cv::Vec2f(static_cast<float>(column), static_cast<float>(row));
  }
  cv::Mat warped;
  cv::remap(image, warped, targets, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return warped;
}

}  // namespace radar_dot
