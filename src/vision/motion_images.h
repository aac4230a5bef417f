// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// @throws std::invalid_argument naming the image that is of another type or size than the camera's grid.
void requireImage(const cv::Mat& image, int type, const CameraIntrinsics& camera, const char* name,
                  const char* type_name);

}  // namespace radar_dot
