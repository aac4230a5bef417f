// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/simulation/mesh.h"

namespace radar_dot::simulation {

/// Lines of a passenger car or a delivery van, m; x counts from the middle, z from the ground.
struct CarShape {
  float length = 4.2F;
  float width = 1.78F;
  float height = 1.47F;
  float clearance = 0.18F;
  float wheel_radius = 0.32F;
  float front_axle_x = 1.2F;
  float rear_axle_x = -1.35F;
  float nose_z = 0.74F;  ///< front end of the bonnet
  float cowl_z = 0.98F;  ///< foot of the windscreen
  float tail_z = 0.98F;  ///< foot of the rear window
  float cowl_x = 1.05F;
  float roof_front_x = 0.3F;
  float roof_rear_x = -1.6F;
  float rear_base_x = -1.98F;
  float roof_drop = 0.06F;   ///< of the rear end of the roof
  float tumblehome = 0.17F;  ///< the roof is narrower than the belt line, on either side
  float glass_top = 0.86F;   ///< fraction of the cabin's side that the windows reach up to
  bool rear_doors = true;
  bool rear_side_windows = true;  ///< beside the rear bench
  bool quarter_windows = false;   ///< behind the rear doors
  bool upright_tail_lamps = false;
  bool dark_trim = false;  ///< unpainted arches and sills

  /// Height of the bonnet, belt line and boot at x.
  float deck(float x) const;
};

/// The whole body without wheels; palette slot 0 is its paint.
Mesh buildCarBody(const CarShape& shape);

}  // namespace radar_dot::simulation
