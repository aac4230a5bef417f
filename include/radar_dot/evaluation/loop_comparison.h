// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot::evaluation {

/// Result over all scenes with the two directions of the loop between mask and radar on or off.
struct LoopResult {
  bool mask_to_velocity = false;  ///< SegmentationEvaluationOptions::mask_to_velocity
  bool radar_to_mask = false;     ///< MotionParams::radar_gain is not 0
  SegmentationReport overall;
};

/// Options with neither direction, mask_to_velocity, radar_to_mask and both, in this order. The gain is that
/// of `options`, or its default where that is 0. Masks are saved only by the one that `options` itself is.
std::vector<SegmentationEvaluationOptions> loopVariants(const SegmentationEvaluationOptions& options);
/// Place in loopVariants of what `options` itself says.
std::size_t ownVariant(const SegmentationEvaluationOptions& options);

/// Plain-text table with a line for each result; velocity error in m/s.
std::string formatLoopTable(const std::vector<LoopResult>& results);
/// formatJson of the scenes with a further member "loop": [{"mask_to_velocity", "radar_to_mask", "overall":
/// {as of the scenes}}].
std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const std::vector<LoopResult>& results);

/// Sums the comparisons in files of formatJson; empty where none of them has one.
/// @throws std::runtime_error naming file and field for what is no such file, and the file that has none
///         where others have.
std::vector<LoopResult> mergeLoop(const std::vector<std::string>& files);

}  // namespace radar_dot::evaluation
