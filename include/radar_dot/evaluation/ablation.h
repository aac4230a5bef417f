// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot::evaluation {

/// One step from the paper's masks to the package's best.
struct AblationStep {
  std::string name;
  SegmentationEvaluationOptions options;
};
/// What a step reaches.
struct AblationResult {
  std::string name;
  std::vector<SegmentationReport> scenes;
  SegmentationReport overall;
};

/// s, of the step "+ memory", where the options have none.
inline constexpr double kMemory = 0.4;

/// "paper", "+ uncertainty", "+ refinement", "+ radar evidence", "+ look back", "+ memory", in this order:
/// the paper's score without radar in the mask; the score by uncertainty, with forward and backward flow as
/// its noise; the motion refined by the image; radar returns that move the threshold, with the gains of
/// `options`, or their defaults where those are 0; the previous pair; and what the mask before said. The last
/// two are left out for flow that is no backend's. Everything else is as in `options`. Masks are
/// saved in a folder of each step: "paper", "uncertainty", "refinement", "radar_evidence", "look_back",
/// "memory".
std::vector<AblationStep> ablationSteps(const SegmentationEvaluationOptions& options);

/// Those of the last step, but masks are saved where `options` say so.
SegmentationEvaluationOptions bestOptions(const SegmentationEvaluationOptions& options);

/// Plain-text table: a line for each step; IoU of every scene and overall, precision, recall, F1, share of
/// what does not move that is in the mask, and ms per mask overall.
std::string formatAblationTable(const std::vector<AblationResult>& results);
/// formatJson of the scenes with a further member "ablation": [{"name", "scenes": [...], "overall": {...}}].
std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const std::vector<AblationResult>& results);

/// The scenes of all files side by side, and their sums; empty where none of the files has an ablation.
/// @throws std::runtime_error naming file and field for what is no such file, and the file that has none, or
///         other steps, where others have.
std::vector<AblationResult> mergeAblation(const std::vector<std::string>& files);

}  // namespace radar_dot::evaluation
