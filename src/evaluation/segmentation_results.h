// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/evaluation/segmentation_evaluation.h"

// Comparisons of several runs, and the files they are merged from.

namespace radar_dot::evaluation {

/// Variants of the options that are compared.
enum class Variants {
  /// The directions of the loop between mask and radar: "neither", "mask_to_velocity", "radar_to_mask" and
  /// "both", in this order. The gain is that of the options, or its default where that is 0. Masks are saved
  /// only by the one that the options are themselves.
  kLoop,
  /// "paper", "+ uncertainty", "+ refinement", "+ radar evidence", "+ image borders", "+ look back", "+
  /// memory", in this order:
  /// the paper's score without radar in the mask; the score by uncertainty, with forward and backward flow as
  /// its noise; the motion refined by the image; radar returns that move the threshold, with the gains of the
  /// options, or their defaults where those are 0; borders moved to edges of the image; the previous pair;
  /// the
  /// previous mask. The last two are left out for flow that is no backend's. Everything else is as in the
  /// options. Masks are saved
  /// in folders "paper", "uncertainty", "refinement", "radar_evidence", "image_borders", "look_back" and
  /// "memory".
  kAblation
};

/// One run, and what it reached.
struct VariantResult {
  std::string name;
  SegmentationEvaluationOptions options;
  std::vector<SegmentationReport> scenes;
  SegmentationReport overall;
};
struct Comparison {
  Variants variants = Variants::kLoop;
  std::vector<VariantResult> results;
};

/// s, of the step "+ memory", where the options have none.
inline constexpr double kMemory = 0.4;
inline constexpr int kBorder = 40;  // px

/// The runs to be made.
Comparison comparisonOf(Variants variants, const SegmentationEvaluationOptions& options);
/// Place among them of what the options say themselves; of an ablation the last.
std::size_t ownVariant(const Comparison& comparison, const SegmentationEvaluationOptions& options);
/// Those of the last step of an ablation, but masks are saved where `options` say so.
SegmentationEvaluationOptions bestOptions(const SegmentationEvaluationOptions& options);

/// Plain-text table with a line for each variant.
std::string formatTable(const Comparison& comparison);
/// formatJson of the scenes with a further member: "loop": [{"mask_to_velocity", "radar_to_mask", "overall":
/// {as of the scenes}}], or "ablation": [{"name", "scenes": [...], "overall": {...}}].
std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const Comparison& comparison);

/// Sums the comparisons in files of formatJson, the scenes of an ablation side by side; none where no file
/// has one.
/// @throws std::runtime_error naming file and field for what is no such file, and the file that has none, or
///         other variants, where others have.
std::optional<Comparison> mergeComparison(const std::vector<std::string>& files);

}  // namespace radar_dot::evaluation
