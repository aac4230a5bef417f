// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgproc.hpp>

namespace radar_dot {

/// Mean square of the change of a grey image from px to px, over windows of that width (px), CV_32FC1.
inline cv::Mat meanSquareChange(const cv::Mat& grey, int window) {
  cv::Mat sideways, downwards, change;
  cv::Scharr(grey, sideways, CV_32F, 1, 0, 1.0 / 32.0);
  cv::Scharr(grey, downwards, CV_32F, 0, 1, 1.0 / 32.0);
  cv::multiply(sideways, sideways, sideways);
  cv::accumulateSquare(downwards, sideways);
  cv::boxFilter(sideways, change, -1, {window, window});
  return change;
}

}  // namespace radar_dot
