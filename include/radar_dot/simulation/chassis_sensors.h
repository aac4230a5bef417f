// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {

/// Sensors of the chassis; sigma of white noise.
struct ChassisModel {
  double acceleration_noise = 0.15;  ///< m/s^2
  double rotation_noise = 0.006;     ///< rad/s
  double wheel_noise = 0.25;         ///< revolutions per minute
  double wheel_base = 2.588;         ///< m
  double track = 1.511;              ///< m
  double steering_ratio = 15.2;      ///< steering wheel over front wheels
};

/// Pose at 50 Hz, IMU and wheels at 100 Hz from `begin_s` to `end_s` (s of the trajectory; time stamps
/// are start_us later). The IMU sits at base_link with its axes, and feels gravity.
dataset::CanBus simulateCanBus(const Trajectory& ego, double begin_s, double end_s, std::int64_t start_us,
                               const ChassisModel& model, std::uint64_t seed);

}  // namespace radar_dot::simulation
