// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"
#include "radar_dot/common/radar_noise.h"
#include "radar_dot/vision/ground_plane.h"

namespace radar_dot {

/// Parameters of the backend radar_ground: the ground plane, radar returns as upright columns, and a
/// background in their directions.
struct RadarGroundParams {
  GroundParams ground;
  double column_height = 1.6;
  double column_half_width = 0.9;
  double azimuth_std = RadarNoise{}.azimuth_std;
  // Heights between 0.6 and 2 times, widths between 0.4 and 1.6 times the expected one. Without an image
  // there is nothing to move to.
  bool image_edges = false;
  double background_depth =
      40.0;  // of what is above the horizon and in no column; hides the ground behind it
  double background_angle = 0.1;
  double column_std = 0.35;
  double background_std = 0.5;

  void describe(FieldList& fields) {
    ground.describe(fields);
    fields.add("column_height", column_height, "Height of the upright column that a return stands for", "m",
               {0.1, 100.0});
    fields.add("column_half_width", column_half_width, "Lower limit of the half width of the column", "m",
               {0.01, 100.0});
    describeAzimuthStd(azimuth_std, fields);
    fields.add("image_edges", image_edges, "Move the borders of columns to edges of the image");
    fields.add("background_depth", background_depth,
               "Depth above the horizon where the radar sees nothing; 0: unknown", "m", {0.0, 10000.0});
    fields.add("background_angle", background_angle,
               "1 sigma of the angle over which columns pull the background nearer", "rad", {0.001, 3.2});
    fields.add("column_std", column_std, "1 sigma of the inverse depth in columns, relative", "",
               {1e-6, 10.0});
    fields.add("background_std", background_std, "1 sigma of the inverse depth of the background, relative",
               "", {1e-6, 10.0});
  }
};

}  // namespace radar_dot
