// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/scenario.h"
#include "simulation/bodies/stock.h"
#include "simulation/scenarios/path_trajectory.h"
#include "simulation/scenarios/traffic.h"
#include "simulation/street/street_builder.h"
#include "simulation/street/street_plan.h"

namespace radar_dot::simulation {

/// What all scenarios are made of.
struct ScenarioKit {
  ScenarioKit(double duration, std::uint64_t seed_of_all)
      : duration_s(duration), seed(seed_of_all), random(seed_of_all, 1), stock(RandomStream(seed_of_all, 2)) {
    heading = random.uniform(-3.1, 3.1);
  }

  double duration_s;
  std::uint64_t seed;
  double heading = 0.0;  ///< rad, of the first street in the map
  RandomStream random;
  Stock stock;
  StreetPlan plan;
  World world;
  std::shared_ptr<const SprungTrajectory> ego;

  /// The first street, with its middle in the origin of the map.
  void addMainStreet(const StreetProfile& profile, double length);
  /// Small streets that cross it every hundred metres or so, first at `first` m.
  void addSideStreets(double first);
  /// Path along a street at a distance from its middle; against its direction where `backwards`, and then
  /// lengths count from its end.
  std::shared_ptr<const Path> along(const Street& street, double y, bool backwards = false) const;
  /// The ego on a path, base_link at `start` m at time 0.
  void drive(const std::shared_ptr<const Path>& path, const SpeedProfile& profile, double start);
  /// Daylight with the sun at this azimuth (rad, from the direction of the first street) and elevation (rad);
  /// grey: 0 clear to 1 overcast.
  void shine(double azimuth, double elevation, float grey);
  void buildWorld() { buildStreets(plan, stock, seed, world); }
  Traffic traffic() { return Traffic(world, plan, stock, *ego, duration_s, seed); }
  /// Parked bicycles on the pavement.
  void parkBicycles(Traffic& traffic, const Street& street, double low, double high, double spacing);
  Stock::Models someCars(int count);
  Street& main() { return plan.streets.front(); }
};

/// People who want to cross the street at a zebra, starting at random times; those who cannot do not.
void addCrossers(Traffic& traffic, const Street& street, double zebra, double from_time, double to_time,
                 int attempts);

// The scenarios, in the order of the suite; each fills the kit's world and ego.
void makeCrossing(ScenarioKit& kit);
void makeParkedCars(ScenarioKit& kit);
void makeStopAndGo(ScenarioKit& kit);
void makeOncoming(ScenarioKit& kit);
void makeCarPark(ScenarioKit& kit);
void makeStanding(ScenarioKit& kit);
void makeNight(ScenarioKit& kit);
void makeBusOvertaking(ScenarioKit& kit);
void makeCyclists(ScenarioKit& kit);
void makePedestrians(ScenarioKit& kit);

}  // namespace radar_dot::simulation
