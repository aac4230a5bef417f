// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/mesh.h"

namespace radar_dot::simulation {

/// Colours and measures that all parts of one front share.
struct BuildingStyle {
  Surface wall, plinth, trim, frame, pane, roof;
  Surface door, sign, awning;
  float storey = 3.2F;  ///< m
  float ground_storey = 3.6F;
  float window_width = 1.2F;
  float window_height = 1.7F;
  float sill = 0.85F;  ///< m above the floor
  float setback = 0.14F;
  int mullions = 1;
  bool transom = true;
  bool pitched = false;
  bool lintels = false;
  bool bands = false;
  float balconies = 0.0F;  ///< fraction of the bays
  bool awnings = false;
};

BuildingStyle randomBuildingStyle(RandomStream& random);

}  // namespace radar_dot::simulation
