// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace radar_dot {

/// Which components of the base frame's motion are estimated; the others are taken as zero.
enum class MotionModel : std::uint8_t {
  kPlanar,     ///< vx, vy: the paper's model
  kPlanarYaw,  ///< vx, vy, yaw rate
  kAckermann,  ///< vx, yaw rate; base frame at the rear axle, where vy = 0 without slip
  kSpatial,    ///< vx, vy, vz: for radars that measure elevation
};

/// "planar", "planar_yaw", "ackermann", "spatial".
std::string_view toString(MotionModel model) noexcept;

/// Inverse of toString. @throws std::invalid_argument listing the names.
MotionModel motionModelFromString(std::string_view name);

}  // namespace radar_dot
