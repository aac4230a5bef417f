// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/optical_flow.h"
#include "vision/resize_nearest.h"

namespace radar_dot::evaluation {

/// A whole image, CV_8UC3 (BGR). @throws dataset::DatasetError naming the file.
cv::Mat readColour(const std::filesystem::path& file);

/// Flow of a PNG in KITTI's 16-bit form, px of its own grid; not valid and NaN where it says so.
/// @throws dataset::DatasetError naming the file.
FlowField readFlow(const std::filesystem::path& file);

/// Depth of a 16-bit PNG, m * 256; NaN where it is 0. CV_32FC1, m.
/// @throws dataset::DatasetError naming the file.
cv::Mat readDepth(const std::filesystem::path& file);

/// A CV_8UC1 PNG, as it is. @throws dataset::DatasetError naming the file.
cv::Mat readGrey(const std::filesystem::path& file);

using radar_dot::resizeNearest;

/// The value nearest to each pixel's centre on another grid, with the vectors scaled to px of that grid.
FlowField resizeNearest(const FlowField& field, const cv::Size& size);

}  // namespace radar_dot::evaluation
