// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// What moves by itself between two rectified images: CV_8UC1 of their size, 255 = moves. Flow by DIS there
/// and back, score by uncertainty, with the defaults of OpticalFlowParams and MotionParams.
/// A stream of images wants an OpticalFlow and a MotionSegmenter, or a MaskPipeline, which keep their memory.
///
/// @param first, second            CV_8UC3 or CV_8UC1
/// @param depth                    CV_32FC1, m, at the first image; NaN: unknown
/// @param camera                   of the images
/// @param T_current_from_previous  m; takes static points from the camera frame at the first image to that
///                                 at the second: staticPointMotion of the vehicle's motion
/// @throws std::invalid_argument where sizes or types do not go together
cv::Mat imagePairMask(const cv::Mat& first, const cv::Mat& second, const cv::Mat& depth,
                      const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous);

}  // namespace radar_dot
