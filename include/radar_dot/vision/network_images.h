// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

namespace radar_dot {

/// An image of another size: areas where it gets smaller, bilinear where it grows; itself where it has it.
cv::Mat resizedImage(const cv::Mat& image, const cv::Size& size);

/// An image as networks take it: planes of red, green and blue, one below the other (CV_32FC1, three times as
/// many rows), each value times `factor` plus `offset` of its plane.
/// @param image   CV_8UC3 (BGR) or CV_8UC1
/// @param planes  the result; its memory is used again
void colourPlanes(const cv::Mat& image, const std::array<double, 3>& factor,
                  const std::array<double, 3>& offset, cv::Mat& planes);

}  // namespace radar_dot
