// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// How well the ground plane is known, 1 sigma.
struct GroundUncertainty {
  double pitch_std = 0.02;
  double height_std = 0.05;
  double relative_std = 0.1;

  void describe(FieldList& fields) {
    fields.add("ground_pitch_std", pitch_std, "1 sigma of the pitch of the ground ahead", "rad", {0.0, 0.5});
    fields.add("ground_height_std", height_std, "1 sigma of the height of the ground", "m", {0.0, 10.0});
    fields.add("ground_relative_std", relative_std,
               "1 sigma of the inverse depth of ground that is not flat, relative", "", {0.0, 10.0});
  }
};

/// The plane of the ground in the base frame.
struct GroundParams {
  double pitch = 0.0;   ///< rad, against the base frame's x-y plane, nose down positive
  double height = 0.0;  ///< m
  GroundUncertainty uncertainty;

  void describe(FieldList& fields) {
    fields.add("ground_pitch", pitch, "Pitch of the ground in the base frame, nose down positive", "rad",
               {-0.5, 0.5});
    fields.add("ground_height", height, "Height of the ground in the base frame", "m", {-10.0, 10.0});
    uncertainty.describe(fields);
  }
};

}  // namespace radar_dot
