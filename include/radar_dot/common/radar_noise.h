// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// The bearing's part of RadarNoise, for who needs no more. @param azimuth_std  rad
inline void describeAzimuthStd(double& azimuth_std, FieldList& fields) {
  fields.add("azimuth_std", azimuth_std, "1 sigma of the bearing of a radar return", "rad", {0.0, 1.0});
}

/// Noise of one radar return, the same for everything that weighs returns.
struct RadarNoise {
  double doppler_std = 0.12;
  double azimuth_std = 0.0175;  // its effect on a velocity grows with the transverse speed

  void describe(FieldList& fields) {
    fields.add("doppler_std", doppler_std, "1 sigma of the Doppler velocity of a return", "m/s",
               {0.001, 100.0});
    describeAzimuthStd(azimuth_std, fields);
  }
};

}  // namespace radar_dot
