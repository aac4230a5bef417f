// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/annotation_labels.h"
#include "radar_dot/evaluation/object_evaluation.h"

namespace radar_dot::evaluation {

enum class BoxState : std::uint8_t {
  kStands,
  kMoves,
  kUnknown,  ///< attribute and speed contradict each other, or there is no speed
};

/// A box of a keyframe with what is known of it.
struct AnnotatedObject {
  MovingBox box;
  dataset::Index instance = dataset::kNone;
  MoverKind kind = MoverKind::kOther;
  BoxState state = BoxState::kStands;

  /// Is `position` (m, map frame) in the box, moved to `time` and grown by `margin` (m)?
  bool contains(const Eigen::Vector2d& position, double time, double margin) const;
};

/// Of the name of a category, e.g. "vehicle.car".
MoverKind kindOf(const std::string& category);

/// @param has_speed  does the track have other boxes?
/// @param is_called_moving  by the attribute
BoxState stateOf(const MovingBox& box, bool has_speed, bool is_called_moving, double min_speed);

/// The boxes of a keyframe; see evaluateObjects for their states.
std::vector<AnnotatedObject> annotatedObjects(const dataset::Tables& tables, dataset::Index sample,
                                              double min_speed);

}  // namespace radar_dot::evaluation
