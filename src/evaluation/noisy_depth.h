// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace radar_dot::evaluation {

/// Errors of a depth network, as noisyDepth makes them. The defaults give, on the simulated suite at 800x450
/// px, the mean absolute errors that JustDepth reports on nuScenes: 1.3, 1.7 and 1.8 m within 50, 70 and 80
/// m.
struct NoisyDepthParams {
  static constexpr double kReferenceDepth = 30.0;  ///< m
  double relative_std = 0.102;  ///< 1 sigma of the smooth factor on the depth, at kReferenceDepth
  double growth = 0.8;          ///< power of the depth that this sigma grows with
  int cell = 160;               ///< px at 1600 px image width, size of the patches that err together
  int bleeding = 9;             ///< px at 1600 px image width, over which edges are smeared
  double hole_share = 0.01;     ///< of the picture, in round holes
};

/// True depth (CV_32FC1, m, NaN = unknown) with a smooth multiplicative error, edges that bleed, and holes.
/// What is unknown stays so. Same seed, same errors.
/// @throws std::invalid_argument for an image of another type, or invalid parameters.
cv::Mat noisyDepth(const cv::Mat& true_depth, const NoisyDepthParams& params, std::uint64_t seed);

/// 1 sigma of the inverse of a noisy depth, relative, by its true model: relative_std (depth /
/// kReferenceDepth)^growth. Edges that bleed err more. CV_32FC1, NaN where the true or the noisy depth is
/// unknown. @param true_depth, noisy_depth  CV_32FC1, m, of one size
/// @throws std::invalid_argument for other images
cv::Mat noisyDepthStd(const cv::Mat& true_depth, const cv::Mat& noisy_depth, const NoisyDepthParams& params);

}  // namespace radar_dot::evaluation
