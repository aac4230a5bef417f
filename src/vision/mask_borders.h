// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// Moves the borders of regions to the edges of the image. The flow of what moves reaches over its border by
/// the size of the patches that flow is made of, most of all over road and sky without texture. So what is
/// deep inside of a region, or far from all, is taken as it is, and spreads into the band between up to where
/// the image changes: the fast global smoother of Min et al. (IEEE TIP 2014), of the mask over that of one
/// where it is known. Within regions a pixel counts the more, the more texture there is, and the worse the
/// second image fits where the static world is expected. Where the second or the previous image shows there
/// what the first one does, better than where the flow leads, and would show a shift in any direction, the
/// region is cut.
/// @param mask    CV_8UC1, 0 or 255, of the pair's first image
/// @param pair    with `grey`; without `second_grey` the texture alone counts
/// @param reach   px of the mask, half the width of the band; narrower within small regions
/// @param before  the first image with the previous one (MotionSegmenter::segment); or null
void moveBordersToEdges(cv::Mat& mask, const ImagePairInput& pair, double reach,
                        const ImagePairInput* before = nullptr);

}  // namespace radar_dot
