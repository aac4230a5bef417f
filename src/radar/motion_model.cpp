// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/motion_model.h"

#include <stdexcept>
#include <string>

namespace radar_dot {

std::string_view toString(MotionModel model) noexcept {
  switch (model) {
    case MotionModel::kPlanar: return "planar";
    case MotionModel::kPlanarYaw: return "planar_yaw";
    case MotionModel::kAckermann: return "ackermann";
    case MotionModel::kSpatial: return "spatial";
  }
  return "unknown";
}

MotionModel motionModelFromString(std::string_view name) {
  for (const MotionModel model :
       {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kAckermann, MotionModel::kSpatial}) {
    if (name == toString(model)) return model;
  }
  throw std::invalid_argument("motion model '" + std::string(name) +
                              "' is not one of planar, planar_yaw, ackermann, spatial");
}

}  // namespace radar_dot
