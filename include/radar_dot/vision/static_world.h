// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/vision/camera_intrinsics.h"

// The world without what moves: what is left of masks, images and clouds.

namespace radar_dot {

/// How far each pixel is from what moves: px between centres, 0 on it, infinite where nothing moves. What is
/// kept are the pixels beyond a dilation: a mask of 255 = keep, 0 = moves.
/// @param mask  CV_8UC1, not 0 = moves, on any grid of the image's shape   @param size  px, of the result
/// @return CV_32FC1
cv::Mat distanceToMoving(const cv::Mat& mask, const cv::Size& size);

/// An image in which the pixels that are not kept go on smoothly from those around them, without edges where
/// the two meet; 0 where nothing is kept at all. Pull and push of a pyramid: Gortler et al., The Lumigraph,
/// SIGGRAPH 1996, section 3.3.
/// @param image  CV_8UC3 or CV_8UC1   @param keep  CV_8UC1 of its size, not 0 = keep
cv::Mat filled(const cv::Mat& image, const cv::Mat& keep);

/// Which points are kept: all but those that lie on a pixel that is not. Points that are not finite, behind
/// the camera or out of its view are kept.
/// @param points  m   @param keep  CV_8UC1 on the grid of `camera`, not 0 = keep
/// @return one value per point: 1 = keep, 0 = moves
std::vector<std::uint8_t> keptPoints(const std::vector<Eigen::Vector3f>& points, const cv::Mat& keep,
                                     const CameraIntrinsics& camera,
                                     const Eigen::Isometry3d& T_camera_from_points);

}  // namespace radar_dot
