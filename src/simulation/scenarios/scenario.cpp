// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "simulation/scenarios/scenario_kit.h"

namespace radar_dot::simulation {
namespace {

struct Recipe {
  const char* name;
  const char* description;
  void (*make)(ScenarioKit&);
};

constexpr Recipe kRecipes[] = {
    {"crossing", "Turn left at intersection behind van, peds crossing, cars waiting, parked cars",
     makeCrossing},
    {"parked_cars", "Many parked cars on both sides, peds crossing street between them", makeParkedCars},
    {"stop_and_go", "Stop and go behind dense traffic, oncoming cars, peds on sidewalk", makeStopAndGo},
    {"oncoming", "Heavy oncoming traffic on two lanes, follow car", makeOncoming},
    {"car_park", "Drive slowly through car park, turns, nothing else moves", makeCarPark},
    {"standing", "Wait at red light, cross traffic, peds crossing in front", makeStanding},
    {"night", "Night, street lamps, follow car, oncoming cars, ped crossing", makeNight},
    {"bus_overtaking", "Bus overtakes and stops at bus stop, ego overtakes bus", makeBusOvertaking},
    {"cyclists", "Overtake cyclists on cycle lane, oncoming cyclists, parked cars", makeCyclists},
    {"pedestrians", "Dense peds on sidewalks, stop for peds at crosswalk", makePedestrians},
};

/// @throws std::invalid_argument for an unknown name.
std::size_t numberOf(const std::string& name) {
  const auto found = std::find(scenarioNames().begin(), scenarioNames().end(), name);
  if (found == scenarioNames().end())
    throw std::invalid_argument(
        fmt::format("unknown scenario \"{}\"; there are: {}", name, fmt::join(scenarioNames(), ", ")));
  return static_cast<std::size_t>(found - scenarioNames().begin());
}

}  // namespace

const std::vector<std::string>& scenarioNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Recipe& recipe : kRecipes) list.emplace_back(recipe.name);
    return list;
  }();
  return names;
}

ScenarioInfo scenarioInfo(const std::string& name) {
  const std::size_t number = numberOf(name);
  return {name, fmt::format("scene-{:04}", number + 1), kRecipes[number].description};
}

Scenario makeScenario(const std::string& name, double duration_s, std::uint64_t seed) {
  const std::size_t number = numberOf(name);
  if (!(duration_s > 0.0 && duration_s <= kLongestDrive))
    throw std::invalid_argument(fmt::format("scenario \"{}\": duration {} s is not above 0 and up to {} s",
                                            name, duration_s, kLongestDrive));
  ScenarioKit kit(duration_s, mixBits(seed) + number);
  kRecipes[number].make(kit);
  return {scenarioInfo(name), std::move(kit.world), kit.ego};
}

}  // namespace radar_dot::simulation
