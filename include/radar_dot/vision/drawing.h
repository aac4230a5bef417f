// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

/// Pictures of what the vision room computes. Every function returns a new CV_8UC3 image (BGR) and throws
/// std::invalid_argument naming the argument that is empty or of another type. Unknown values (NaN) are dark
/// grey. Scales and text are drawn where the picture is large enough to read them (200 x 110 px).
namespace radar_dot {

/// Largest magnitude (px) that is worth showing in these flows (CV_32FC2, either may be empty): the 98th
/// percentile of all known vectors, rounded up to 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten; at least 1.
double flowScale(const cv::Mat& flow, const cv::Mat& other = {});

/// The colour wheel of the Middlebury benchmark: hue = direction (right red, down yellow, left blue, up
/// violet), saturation = magnitude, so that no motion is white and `max_flow` or more is a pure colour.
/// @param flow      CV_32FC2, px
/// @param max_flow  px; 0: flowScale(flow)
cv::Mat drawFlow(const cv::Mat& flow, double max_flow = 0.0);

/// The wheel itself, `size` x `size` px (24 or more), with the magnitude at its rim written below: the colour
/// right of its middle is that of flow to the right.
cv::Mat drawFlowLegend(int size, double max_flow);

/// Depth (CV_32FC1, m) on a logarithmic scale from max_depth / 60 (bright) to max_depth (dark); zero or less
/// is unknown.
cv::Mat drawDepth(const cv::Mat& depth, double max_depth = 120.0);

/// Residual or score (CV_32FC1) from 0 (black) to `max` or more (bright yellow), on a scale of
/// square roots: what moves far away shows beside what passes close by.
/// @param max   0: 98th percentile, rounded up as in flowScale
/// @param unit  written at the scale
cv::Mat drawResidual(const cv::Mat& residual, double max = 0.0, const std::string& unit = "px");

/// A radar return seen by the camera.
struct RadarPixel {
  cv::Point2f pixel;      ///< px; whole coordinates are centres of pixels
  float depth = 0.0F;     ///< m, along the optical axis
  float residual = 0.0F;  ///< m/s, radial velocity of its own
  bool dynamic = false;
};

/// Returns on a darkened copy of the image (CV_8UC3 or CV_8UC1): static green, dynamic red with a white rim
/// and some of their radial velocities (m/s), larger when near. Those outside of the image are left out.
cv::Mat drawRadar(const cv::Mat& image, const std::vector<RadarPixel>& points);

/// The image (CV_8UC3 or CV_8UC1) with a translucent mask and its contour, which lies within the mask.
/// @param mask   CV_8UC1 of any size, not 0 = marked; empty: nothing is
/// @param valid  CV_8UC1 of any size, 0 = excluded: darkened and hatched; empty: nothing is
cv::Mat overlayMask(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& valid = {});

/// What sixPanel shows. Everything may be missing, and have a grid of its own.
struct SixPanelInput {
  cv::Mat image;          ///< CV_8UC3 or CV_8UC1
  cv::Mat mask;           ///< CV_8UC1, drawn over the image
  cv::Mat valid;          ///< CV_8UC1, 0 = excluded from the mask
  cv::Mat expected_flow;  ///< CV_32FC2, px of its own grid
  cv::Mat observed_flow;  ///< CV_32FC2, px of its own grid
  cv::Mat residual;       ///< CV_32FC1; empty: difference of the two flows, px of the image
  cv::Mat depth;          ///< CV_32FC1, m
  std::optional<std::vector<RadarPixel>> radar;  ///< px of the image

  double max_flow = 0.0;      ///< px of the image (of the finer flow without one); 0: flowScale of both
  double max_residual = 0.0;  ///< 0: from the residual
  double max_depth = 120.0;   ///< m
  std::string residual_unit = "px";
  cv::Size panel{640, 360};  ///< px, 64 x 36 or more; inputs keep their aspect ratio
};

/// The paper's figure in three columns and two rows: image, residual between expected and observed flow,
/// expected flow; depth, radar returns, observed flow. Both flows share one scale.
cv::Mat sixPanel(const SixPanelInput& input);

}  // namespace radar_dot
