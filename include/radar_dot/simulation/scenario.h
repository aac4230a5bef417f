// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "radar_dot/simulation/trajectory.h"
#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// What a scenario is called.
struct ScenarioInfo {
  std::string name;         ///< e.g. "crossing"
  std::string scene_name;   ///< nuScenes style, e.g. "scene-0001"
  std::string description;  ///< one line, as in scene.json
};

/// A world and a drive through it.
struct Scenario : ScenarioInfo {
  World world;
  /// Of base_link: rear axle, on the ground; with pitch and roll of the body.
  std::shared_ptr<const Trajectory> ego;
};

/// Longest drive, s.
inline constexpr double kLongestDrive = 60.0;

/// Names that makeScenario knows, in the order of the suite.
const std::vector<std::string>& scenarioNames();

/// What there is to say of a scenario without building it.
/// @throws std::invalid_argument for an unknown name, with those that exist.
ScenarioInfo scenarioInfo(const std::string& name);

/// Builds a scenario. Same name, duration and seed: same scenario. The drive is meant for 0 <= time <=
/// duration.
/// @throws std::invalid_argument for an unknown name, with those that exist.
Scenario makeScenario(const std::string& name, double duration_s, std::uint64_t seed);

}  // namespace radar_dot::simulation
