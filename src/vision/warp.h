// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core/mat.hpp>

namespace radar_dot {

/// An image of the second picture's grid as the first one's pixels see it: pixel p shows image(p + flow(p)),
/// bilinear, and the nearest border beyond it. @param flow  CV_32FC2, px
cv::Mat warpedBack(const cv::Mat& image, const cv::Mat& flow);

/// The same of one place of a flow (CV_32FC2), quicker; NaN is in the corner.
inline cv::Vec2f flowAt(const cv::Mat& flow, float u, float v) {
  // In this order zero stands for NaN.
  u = std::min(std::max(0.0F, u), static_cast<float>(flow.cols - 1));
  v = std::min(std::max(0.0F, v), static_cast<float>(flow.rows - 1));
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const int right = std::min(x + 1, flow.cols - 1);
  const auto* above = flow.ptr<cv::Vec2f>(y);
  const auto* below = flow.ptr<cv::Vec2f>(std::min(y + 1, flow.rows - 1));
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  cv::Vec2f value;
  for (int i = 0; i < 2; ++i) {
    const float top = above[x][i] + a * (above[right][i] - above[x][i]);
    const float bottom = below[x][i] + a * (below[right][i] - below[x][i]);
    value[i] = top + b * (bottom - top);
  }
  return value;
}

}  // namespace radar_dot
