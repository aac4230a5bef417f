// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "radar_dot/dataset/can_bus.h"

namespace radar_dot::dataset {

/// Calls visit(name in the file, value) for each field of a row of the CAN bus but its time, in the order of
/// the file.
template <typename Row, typename Visit>
void forEachCanField(Row&& row, const Visit& visit) {
  using Kind = std::decay_t<Row>;
  if constexpr (std::is_same_v<Kind, CanPose>) {
    visit("accel", row.acceleration);
    visit("orientation", row.orientation);
    visit("pos", row.position);
    visit("rotation_rate", row.rotation_rate);
    visit("vel", row.velocity);
  } else if constexpr (std::is_same_v<Kind, CanImu>) {
    visit("linear_accel", row.linear_acceleration);
    visit("q", row.orientation);
    visit("rotation_rate", row.rotation_rate);
  } else {
    visit("FL_wheel_speed", row.front_left_rpm);
    visit("FR_wheel_speed", row.front_right_rpm);
    visit("RL_wheel_speed", row.rear_left_rpm);
    visit("RR_wheel_speed", row.rear_right_rpm);
    visit("odom_speed", row.odometer_speed_kph);
    visit("steer_corrected", row.steering_angle_deg);
  }
}

}  // namespace radar_dot::dataset
