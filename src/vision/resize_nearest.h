// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace radar_dot {

/// The value nearest to each pixel's centre on another grid: between an object and what is behind it there is
/// nothing. An empty image stays empty. The same as cv::INTER_NEAREST_EXACT, which OpenCV 4.2 lacks;
/// cv::INTER_NEAREST takes the corner of a pixel instead of its centre.
cv::Mat resizeNearest(const cv::Mat& image, const cv::Size& size);

}  // namespace radar_dot
