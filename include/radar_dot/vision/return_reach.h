// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// How far a radar return stands for what is beside it, m: `reach` where it is alone. Where returns are
/// dense, as those of imaging radars, each stands for less, so that a car that gives fifty is not widened by
/// any of them.
/// @param places  m, on the ground; such that are not finite have the whole reach
std::vector<float> reachesOf(const std::vector<Eigen::Vector2f>& places, float reach);

/// Draws what returns show of an image, near ones over far ones: from half a metre below each to one and a
/// half above, since radars look at bumpers and grilles.
/// @param points  camera frame
/// @param footprints  CV_16UC1 of the camera's grid: `first` plus the index of a return
void drawReturns(const CameraIntrinsics& camera, const std::vector<CloudPoint>& points,
                 const RadarEvidenceParams& params, std::uint16_t first, cv::Mat& footprints);

}  // namespace radar_dot
