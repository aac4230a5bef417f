// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/simulation/mesh.h"

namespace radar_dot::simulation {

/// Rectangle on the front, which is the plane y = 0 and looks to +y.
struct Opening {
  float left, right, bottom, top;  ///< x and z, m
  float width() const { return right - left; }
};

/// Builds the front of a house, the plane y = 0 that looks to +y, out of walls around openings.
class BuildingFront {
 public:
  /// @param frame of windows
  BuildingFront(MeshBuilder& builder, const Surface& frame) : builder_(builder), frame_(frame) {}

  void wall(const Opening& area);
  /// The wall of a whole bay around one opening, with its reveals.
  void wallAround(const Opening& bay, const Opening& hole, const Surface& surface, float setback);
  /// Pane with frame, mullions and, if `transom_share` > 0, a transom at that fraction of its height.
  void glazing(const Opening& hole, const Surface& pane, float setback, int mullions, float transom_share);
  void block(const Opening& area, float back, float front);
  void sheet(const Opening& area, float y);

 private:
  MeshBuilder& builder_;
  Surface frame_;
};

}  // namespace radar_dot::simulation
