// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// What goes into JustDepth (Yun et al., 2026), a network for depth from one image and one radar, and what
/// comes out. It sees images of 1600 x 900 px without their uppermost 4 rows: 896 is a multiple of 32.
namespace just_depth {

inline constexpr int kWidth = 1600;           ///< px
inline constexpr int kHeight = 900;           ///< px, before the rows are cut
inline constexpr int kCut = 4;                ///< rows, from the top
inline constexpr int kRows = kHeight - kCut;  ///< px, that the network sees

/// The image as the network takes it: 3 x 896 x 1600 planes red, green, blue, one below the other
/// (CV_32FC1, 2688 rows), each value / 255 less the mean of ImageNet, over its standard deviation.
/// @param image   CV_8UC3 (BGR) or CV_8UC1, any size; is brought to 1600 x 900 px first
/// @param planes  the result; its memory is used again
/// @throws std::invalid_argument for an empty image, or other types
void imagePlanes(const cv::Mat& image, cv::Mat& planes);

/// The radar as the network takes it: for each of the 1600 columns the depth (m, z of the camera frame) of
/// the nearest return that falls into it, 0 where there is none. Returns beside, above, below or behind the
/// full image (0 < u < 1600, 0 < v < 900, z > 0) do not count.
/// @param points_base  m, base frame, at the time of the image; with their heights as measured
/// @param camera       of any grid of the camera's full image
std::vector<float> radarColumns(const std::vector<Eigen::Vector3f>& points_base,
                                const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera);

/// Depth on the grid of a camera from what the network gives for 896 x 1600 px: below 0 is clamped to 0, the
/// rows that were cut are NaN, as is what is not finite.
/// @param output  CV_32FC1, 896 x 1600, m
/// @param grid    of the full image, px
/// @throws std::invalid_argument for an output of another size or type
cv::Mat onGrid(const cv::Mat& output, const cv::Size& grid);

}  // namespace just_depth
}  // namespace radar_dot
