// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {
namespace {

constexpr double kVehicleMoves = 0.5;     // m/s
constexpr double kPedestrianMoves = 0.3;  // m/s

bool startsWith(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

}  // namespace

std::string attributeOf(const Actor& actor, double time_s) {
  const std::string& category = actor.model->category;
  const double speed = actor.trajectory->velocity(time_s).norm();
  if (category == "vehicle.bicycle" || category == "vehicle.motorcycle")
    return actor.parked ? "cycle.without_rider" : "cycle.with_rider";
  if (startsWith(category, "vehicle."))
    return actor.parked ? "vehicle.parked" : speed > kVehicleMoves ? "vehicle.moving" : "vehicle.stopped";
  if (startsWith(category, "human."))
    return speed > kPedestrianMoves ? "pedestrian.moving" : "pedestrian.standing";
  return {};
}

}  // namespace radar_dot::simulation
