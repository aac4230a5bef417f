// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// A pair of images looked at from its second one: depths exchanged, the motion and its covariance inverted.
/// Points, their noise and a belief, which belong to the first image, are left out.
/// @param flow     CV_32FC2, px of the grid, from the second image to the first
/// @param fb_error  CV_32FC1, px, its gap; or empty
MotionInput seenFromSecond(const MotionInput& pair, const cv::Mat& flow, const cv::Mat& fb_error);

/// The first image of a pair, seen together with the previous image: the pair that ended with it, seen from
/// its second image, with all that belongs to the image itself as in `pair`. For MotionSegmenter::segment.
MotionInput previousPairFromFirst(const MotionInput& pair, const MotionInput& pair_before,
                                  const cv::Mat& flow_back, const cv::Mat& fb_error);

/// Neither one pair nor all pairs before together say more than these odds, e^6.
constexpr float kMaxLogOdds = 6.0F;

/// Log-odds that a pixel moves, after a pair by the score by uncertainty: how far its score is above the
/// threshold, in standard deviations, within +-kMaxLogOdds. Errors of flow have tails that fall like an
/// exponential, whose logarithm is linear. CV_32FC1, NaN where excluded.
cv::Mat logOdds(const MotionResult& result);

/// What a pair of images said of its first image (logOdds), at the pixels of a later image,
/// times `share`: a belief decays.
/// @param flow_back  CV_32FC2, px of the grid, from the later image to the first of the pair
/// @param share      between 0 and 1, e.g. forgetting(dt, memory)
/// @return CV_32FC1, NaN where nothing is known
/// @throws std::invalid_argument for other types, or sizes that differ
cv::Mat carriedBelief(const cv::Mat& log_odds, const cv::Mat& flow_back, double share);

/// Pixels that show what a mover uncovered: where a static world was in the image before, something moved,
/// and the flow back, which is then that of the mover, does not close. What it says there is not of these
/// pixels.
/// @param before    the image with the image before (previousPairFromFirst)
/// @param log_odds  CV_32FC1, of the image before (logOdds)
/// @param depth     CV_32FC1, m, of the image before
/// @param noise     of the flow
/// @return CV_8UC1, 255 where uncovered; empty without fb_error, which tells
cv::Mat uncoveredPixels(const MotionInput& before, const cv::Mat& log_odds, const cv::Mat& depth,
                        const FlowDepthNoise& noise);

/// Fraction of a belief that is left after `dt` s: exp(-|dt| / memory). @param memory  s; 0: nothing is left
double forgetting(double dt, double memory);

}  // namespace radar_dot
