// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// How wrong flow and depth are, 1 sigma: of the score by uncertainty and of the refinement of the motion. px
/// of the camera's full image.
struct FlowDepthNoise {
  double flow_std = 2.0;
  double flow_std_relative = 0.03;
  double fb_error_weight = 0.2;
  double depth_std = 0.2;

  void describe(FieldList& fields) {
    fields.add("flow_std", flow_std, "1 sigma of each component of the optical flow", "px", {0.0, 1000.0});
    fields.add("flow_std_relative", flow_std_relative, "In addition, as a fraction of the length of the flow",
               "", {0.0, 10.0});
    fields.add("fb_error_weight", fb_error_weight,
               "In addition, as a fraction of the forward-backward error, where available", "", {0.0, 10.0});
    fields.add("depth_std", depth_std,
               "1 sigma of the inverse depth, relative, where use_depth_uncertainty does not give it", "",
               {0.0, 10.0});
  }
};

}  // namespace radar_dot
