// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simulation/scenarios/scenario_kit.h"

// Straight streets where people matter. The ego's base_link begins `behind` m along the street.
namespace radar_dot::simulation {
namespace {

constexpr double kView = 160.0;  // m of street ahead of where the drive ends

}  // namespace

void makeParkedCars(ScenarioKit& kit) {
  constexpr double kSpeed = 8.0, kSlow = 5.0, kBetween = 62.0;
  const double duration = kit.duration_s;
  const double behind = 45.0;
  kit.addMainStreet({}, behind + kSpeed * duration + kView);
  kit.main().parked_share = 0.9;
  // Slows down before every place where people cross.
  SpeedProfileBuilder drive(-1.0, kSpeed);
  drive.keep(1.5).change(kSlow, 2.0).keep(2.2).change(kSpeed, 2.5);
  struct Crossing {
    double x, time;
  };
  std::vector<Crossing> crossings = {{behind + 33.0, 0.2}};
  while (drive.time() < duration + 5.0) {
    drive.keepFor(kBetween - 40.0);
    crossings.push_back({behind + drive.travelled() - kSpeed + 27.0, drive.time() - 1.4});
    drive.change(kSlow, 2.0).keep(2.2).change(kSpeed, 2.5);
  }
  for (const Crossing& crossing : crossings)
    kit.main().kept_clear.push_back({crossing.x - 1.5, crossing.x + 1.5});
  kit.addSideStreets(behind + 118.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY());
  kit.drive(lane, drive.build(), behind);
  kit.shine(1.9, 0.8, 0.05F);

  Traffic traffic = kit.traffic();
  for (const Crossing& crossing : crossings) {
    bool from_right = kit.random.chance(0.5);
    for (int i = 0; i < 4; ++i, from_right = !from_right)
      traffic.addCrossing(street, crossing.x + kit.random.uniform(-1.2, 1.2), from_right,
                          crossing.time + kit.random.uniform(-1.6, 0.6), kit.random.uniform(1.3, 1.75));
  }
  const auto opposite = kit.along(street, -street.profile.laneY(), true);
  for (double x = 20.0; x < street.length - behind - 60.0; x += kit.random.uniform(60.0, 110.0)) {
    const double way = street.length - 14.0 - x;
    SpeedProfileBuilder passing(0.0, 7.5);
    passing.stopAfter(way, 12.0);
    traffic.addVehicle(traffic.anyVehicle(), opposite, passing.build(), x);
  }
  traffic.populatePavements(street, behind, behind + kSpeed * duration + 90.0, 14.0);
  kit.parkBicycles(traffic, street, behind, behind + kSpeed * duration + 90.0, 25.0);
}

void makeCyclists(ScenarioKit& kit) {
  constexpr double kSpeed = 6.8;
  const double duration = kit.duration_s;
  StreetProfile profile;
  profile.cycle_lane = 1.7;
  const double behind = 5.5 * duration + 50.0;
  kit.addMainStreet(profile, behind + kSpeed * duration + kView);
  kit.addSideStreets(behind + 70.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY());
  SpeedProfileBuilder drive(-1.0, kSpeed);
  while (drive.time() < duration + 10.0)
    drive.keep(kit.random.uniform(1.0, 4.0)).change(kit.random.uniform(5.8, kSpeed), 2.5);
  kit.drive(lane, drive.build(), behind);
  kit.shine(-1.2, 0.95, 0.25F);

  Traffic traffic = kit.traffic();
  const auto ride = [&](bool backwards, double x, double speed) {
    const double y = street.profile.cycleY() + kit.random.uniform(-0.25, 0.25);
    traffic.addVehicle(pick(kit.stock.cyclists, kit.random), kit.along(street, backwards ? -y : y, backwards),
                       SpeedProfile::constant(speed), backwards ? street.length - x : x);
  };
  const double far = behind + kSpeed * duration + 100.0;
  for (double x = behind + 11.0; x < far - 4.5 * duration; x += kit.random.uniform(9.0, 20.0))
    ride(false, x, kit.random.uniform(3.6, 4.4));
  for (double x = behind - 15.0; x > 20.0; x -= kit.random.uniform(25.0, 50.0)) ride(false, x, 4.0);
  for (double x = behind + 14.0; x < street.length - 10.0; x += kit.random.uniform(12.0, 28.0))
    ride(true, x, kit.random.uniform(4.0, 5.2));
  // One who crosses ahead, and cars.
  for (double x = 25.0; x < street.length - behind; x += kit.random.uniform(70.0, 120.0)) {
    SpeedProfileBuilder passing(0.0, 8.0);
    passing.stopAfter(street.length - 14.0 - x, 14.0);
    traffic.addVehicle(traffic.anyVehicle(), kit.along(street, -street.profile.laneY(), true),
                       passing.build(), x);
  }
  traffic.addPlatoonWithEgo(kit.someCars(1), kit.someCars(1), lane, *kit.ego, 4.5);
  traffic.populatePavements(street, behind, far, 16.0);
  kit.parkBicycles(traffic, street, behind, far, 14.0);
}

void makePedestrians(ScenarioKit& kit) {
  constexpr double kSpeed = 5.0, kBetween = 60.0, kBraking = 8.0, kWait = 5.0, kFirst = 20.0;
  constexpr double kBeforeZebra = 0.5 * kZebraWidth + 2.3 + 2.05;  // m, of the ego's middle when it stands
  const double duration = kit.duration_s;
  const double behind = 60.0;
  kit.addMainStreet({}, behind + kSpeed * duration + kView);
  struct Stop {
    double zebra, time;
  };
  std::vector<Stop> stops;
  SpeedProfileBuilder drive(0.0, kSpeed);
  double next = kFirst;
  while (drive.time() < duration + 5.0) {
    drive.stopAfter(next - kBeforeZebra - drive.travelled(), kBraking);
    stops.push_back({behind + kEgoMiddle + next, drive.time()});
    drive.keep(kWait).change(kSpeed, 3.0);
    next += kBetween;
  }
  for (const Stop& stop : stops)
    if (stop.zebra < kit.main().length - 30.0) kit.main().zebras.push_back(stop.zebra);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY());
  kit.drive(lane, drive.build(), behind);
  kit.shine(2.9, 0.65, 0.0F);

  Traffic traffic = kit.traffic();
  for (const Stop& stop : stops)
    addCrossers(traffic, street, stop.zebra, std::max(stop.time - 8.0, -9.0), stop.time + 2.0, 80);
  const double far = behind + kSpeed * duration + 80.0;
  traffic.populatePavements(street, behind - 20.0, far, 2.6);
  kit.parkBicycles(traffic, street, behind, far, 18.0);
  // Waits before the first crossing, coming the other way.
  traffic.addPlatoon(kit.someCars(2), kit.along(street, -street.profile.laneY(), true),
                     SpeedProfile::constant(0.0),
                     street.length - (stops.front().zebra + 0.5 * kZebraWidth + 2.0 + 2.5), 1.0);
}

}  // namespace radar_dot::simulation
