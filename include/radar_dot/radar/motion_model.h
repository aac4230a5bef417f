// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "radar_dot/common/enum_names.h"

namespace radar_dot {

/// Which components of the base frame's motion are estimated; the others are taken as zero.
enum class MotionModel : std::uint8_t {
  kPlanar,
  kPlanarYaw,
  kAckermann,  // vy = 0 at the rear axle without slip
  kSpatial,
};
template <>
struct EnumNames<MotionModel> {
  static constexpr EnumName<MotionModel> kValues[] = {
      {MotionModel::kPlanar, "planar", "vx, vy: the model of the paper"},
      {MotionModel::kPlanarYaw, "planar_yaw", "vx, vy and the yaw rate"},
      {MotionModel::kAckermann, "ackermann", "vx and the yaw rate; the base frame is at the rear axle"},
      {MotionModel::kSpatial, "spatial",
       "vx, vy, vz and the yaw rate, as far as the mounts tell them: for radars that measure elevation"}};
};

}  // namespace radar_dot
