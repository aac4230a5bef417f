// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

// Parameters that several parts of the image half have in common, each declared once.

namespace radar_dot {

/// @param max_depth  m
inline void describeMaxDepth(double& max_depth, FieldList& fields) {
  fields.add("max_depth", max_depth, "Depth beyond which it counts as unknown", "m", {0.1, 10000.0});
}

/// @param working_width  px
inline void describeWorkingWidth(int& working_width, FieldList& fields) {
  fields.add("working_width", working_width,
             "Width of the grid of flow, depth and mask; 0: that of the image", "px", {0, 100000});
}

}  // namespace radar_dot
