// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// A return with its bearing where it was when the velocity was measured.
struct RotatedReturn {
  Eigen::Vector3f bearing;  ///< unit vector, base frame
  float doppler;            ///< m/s
};

/// With the reported velocity vector V, the turned bearing is u' = u + r (z x u) and the range rate u'.V.
inline RotatedReturn rotatedReturn(const DopplerReturn& measured, const Eigen::Matrix3f& R_base_from_sensor,
                                   double bearing_rotation) {
  if (bearing_rotation == 0.0) return {R_base_from_sensor * measured.bearing, measured.doppler};
  // The rotation is about the vertical of the base frame; the sensor may hang upside down.
  const float angle = static_cast<float>(bearing_rotation) * R_base_from_sensor(2, 2);
  const Eigen::Vector3f& u = measured.bearing;
  const Eigen::Vector3f turned = (u + angle * Eigen::Vector3f(-u.y(), u.x(), 0.F)).normalized();
  return {R_base_from_sensor * turned, measured.doppler + angle * measured.tangential_speed};
}

}  // namespace radar_dot
