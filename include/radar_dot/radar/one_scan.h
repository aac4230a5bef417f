// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// A return by its polar coordinates in the frame of the sensor. @param range  m
/// @param azimuth, elevation  rad, to the left and up  @param doppler  m/s, positive when the range grows
inline DopplerReturn polarReturn(double range, double azimuth, double doppler, double elevation = 0.0) {
  DopplerReturn seen;
  seen.bearing = Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                     .cast<float>();
  seen.range = static_cast<float>(range);
  seen.doppler = static_cast<float>(doppler);
  return seen;
}

/// Velocity of a vehicle, and which returns move, from one scan of one radar. With the ackermann model one
/// radar tells the forward speed and the yaw rate of a base frame at the rear axle.
/// A stream of scans wants an EgoVelocityEstimator, which keeps its memory; several radars a SweepEstimator.
inline EgoVelocityResult egoVelocityOf(const std::vector<DopplerReturn>& returns,
                                       const Eigen::Isometry3d& T_base_from_sensor,
                                       MotionModel model = MotionModel::kAckermann) {
  EgoVelocityParams params;
  params.model = model;
  RadarScan scan;
  scan.returns = returns;
  scan.T_base_from_sensor = T_base_from_sensor;
  return EgoVelocityEstimator(params).estimate({scan}, 0.0);
}

}  // namespace radar_dot
