// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace radar_dot {

/// Where the flow (CV_32FC2, px) leads: p + flow(p), CV_32FC2.
cv::Mat targetsOf(const cv::Mat& flow);

/// An image of the second picture's grid as the first one's pixels see it: pixel p shows image(targets(p)),
/// bilinear, and the nearest border beyond it.
cv::Mat warpedBack(const cv::Mat& image, const cv::Mat& targets);

}  // namespace radar_dot
