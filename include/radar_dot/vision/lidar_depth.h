// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// Parameters of the backend lidar, a projected sweep whose gaps are closed:
/// sigma^2 = point_std^2 + (completion_std px)^2. Beams of a 32-beam lidar are 30 px apart.
struct LidarParams {
  int completion_kernel = 40;
  double point_std = 0.005;
  double completion_std = 0.0012;

  void describe(FieldList& fields) {
    fields.add("completion_kernel", completion_kernel,
               "Largest gap between points that is filled, at 1600 px image width", "px", {1, 199});
    fields.add("lidar_std", point_std, "1 sigma of the inverse depth at a point, relative", "", {1e-6, 10.0});
    fields.add("completion_std", completion_std,
               "In addition, relative, for each px to the nearest point at 1600 px image width", "1/px",
               {0.0, 10.0});
  }
};

}  // namespace radar_dot
