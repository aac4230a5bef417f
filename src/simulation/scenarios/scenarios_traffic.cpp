// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simulation/scenarios/scenario_kit.h"

// Straight streets where the other vehicles matter. The ego's base_link begins `behind` m along the street.
namespace radar_dot::simulation {
namespace {

constexpr double kView = 160.0;  // m of street ahead of where the drive ends

/// Adds a stream against the street's direction on a lane, from its far end to behind the ego.
void addOncoming(ScenarioKit& kit, Traffic& traffic, int lane, double speed, double headway) {
  const Street& street = kit.main();
  const double queue = Traffic::queueLength(kit.duration_s, speed, headway);
  traffic.addStream(kit.along(street, -street.profile.laneY(lane), true),
                    {queue, street.length - 8.0, speed, headway, 0.0});
}

}  // namespace

void makeStopAndGo(ScenarioKit& kit) {
  constexpr double kOncoming = 8.0, kHeadway = 3.5, kBehindHeadway = 1.1;
  const double queue = Traffic::queueLength(kit.duration_s, kOncoming, kHeadway);
  const double behind = queue + 60.0;
  kit.addMainStreet({}, behind + 3.4 * kit.duration_s + 120.0 + kView + queue);
  kit.addSideStreets(behind + 52.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY());
  SpeedProfileBuilder drive(-1.0, 5.5);
  drive.keep(1.2).change(0.0, 3.0).keep(1.8);
  while (drive.time() < kit.duration_s + 30.0) {
    const double speed = kit.random.uniform(5.5, 7.5);
    drive.change(speed, 3.2)
        .keep(kit.random.uniform(1.0, 3.5))
        .change(0.0, 3.2)
        .keep(kit.random.uniform(1.5, 3.0));
  }
  kit.drive(lane, drive.build(), behind);
  kit.shine(0.9, 0.9, 0.6F);
  Traffic traffic = kit.traffic();
  Stock::Models ahead = kit.someCars(7);
  ahead[4] = pick(kit.stock.trucks, kit.random);
  ahead[1] = pick(kit.stock.buses, kit.random);
  traffic.addPlatoonWithEgo(ahead, kit.someCars(5), lane, *kit.ego, kBehindHeadway);
  addOncoming(kit, traffic, 0, kOncoming, kHeadway);
  const double far = behind + 3.6 * kit.duration_s + 110.0;
  traffic.populatePavements(street, behind - 20.0, far, 10.0);
  kit.parkBicycles(traffic, street, behind, far, 35.0);
}

void makeOncoming(ScenarioKit& kit) {
  constexpr double kSpeed = 10.5, kFast = 12.5, kSlow = 11.0, kFastHeadway = 1.7, kSlowHeadway = 2.6;
  const double queue = Traffic::queueLength(kit.duration_s, kFast, kFastHeadway);
  StreetProfile wide;
  wide.lanes = 2;
  wide.parking = 0.0;
  wide.front_garden = 4.0;
  const double behind = queue + 40.0;
  kit.addMainStreet(wide, behind + kSpeed * kit.duration_s + 30.0 + kView + queue);
  kit.main().tree_share = 0.9;
  kit.addSideStreets(behind + 75.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY(0));
  SpeedProfileBuilder drive(0.0, kSpeed - 0.5);
  while (drive.time() < kit.duration_s + 10.0)
    drive.change(kit.random.uniform(9.5, kSpeed), 3.0).keep(kit.random.uniform(0.0, 3.0));
  kit.drive(lane, drive.build(), behind);
  kit.shine(0.35, 0.55, 0.0F);
  Traffic traffic = kit.traffic();
  traffic.addPlatoonWithEgo(kit.someCars(2), kit.someCars(2), lane, *kit.ego, 1.9);
  traffic.addPlatoon(kit.someCars(4), kit.along(street, street.profile.laneY(1)),
                     SpeedProfile::constant(kSpeed - 0.9), behind + 75.0, 1.6);
  addOncoming(kit, traffic, 0, kFast, kFastHeadway);
  addOncoming(kit, traffic, 1, kSlow, kSlowHeadway);
  traffic.populatePavements(street, behind, behind + kSpeed * kit.duration_s + 90.0, 24.0);
}

void makeNight(ScenarioKit& kit) {
  constexpr double kSpeed = 8.0, kOncoming = 9.0, kHeadway = 3.4;
  const double queue = Traffic::queueLength(kit.duration_s, kOncoming, kHeadway);
  const double behind = queue + 40.0;
  kit.addMainStreet({}, behind + kSpeed * kit.duration_s + 40.0 + kView + queue);
  kit.main().tree_share = 0.4;
  const double crossing = behind + 5.0 + 34.0;
  kit.main().kept_clear.push_back({crossing - 4.0, crossing + 4.0});
  kit.addSideStreets(behind + 80.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const auto lane = kit.along(street, street.profile.laneY());
  SpeedProfileBuilder drive(-2.0, kSpeed);
  drive.keep(2.3).change(4.5, 2.5).keep(1.2);
  while (drive.time() < kit.duration_s + 10.0)
    drive.change(kit.random.uniform(7.2, kSpeed), 3.0).keep(kit.random.uniform(1.0, 4.0));
  kit.drive(lane, drive.build(), behind);

  Lighting& lighting = kit.world.lighting;
  lighting.night = true;
  lighting.to_sun = Eigen::Vector3f(0.3F, 0.3F, 0.906F).normalized();
  lighting.sun = Color(0.0030F, 0.0036F, 0.0050F);  // the moon, for the eye
  lighting.zenith = Color(0.0025F, 0.0035F, 0.0070F);
  lighting.horizon = Color(0.0140F, 0.0110F, 0.0090F);
  for (const StaticObject& object : kit.world.statics) {
    if (object.mesh != kit.stock.street_lamp) continue;
    Lamp lamp;
    lamp.position =
        (object.T_map_from_object * Eigen::Vector3d(Stock::kLampReach, 0.0, Stock::kLampHeight - 0.15))
            .cast<float>();
    lamp.intensity = Color(1.0F, 0.78F, 0.50F) * 40.0F;
    lighting.lamps.push_back(lamp);
  }

  Traffic traffic = kit.traffic();
  traffic.addCrossing(street, crossing, true, 0.2, 1.5);
  traffic.addPlatoonWithEgo({pick(kit.stock.cars, kit.random)}, kit.someCars(1), lane, *kit.ego, 3.2);
  addOncoming(kit, traffic, 0, kOncoming, kHeadway);
  traffic.populatePavements(street, behind + 10.0, behind + kSpeed * kit.duration_s + 60.0, 24.0);
}

void makeBusOvertaking(ScenarioKit& kit) {
  constexpr double kSpeed = 7.0, kBusSpeed = 10.0, kOncoming = 10.0, kHeadway = 3.6;
  const double duration = kit.duration_s;
  const double queue = Traffic::queueLength(duration, kOncoming, kHeadway);
  const double behind = std::max(queue + 40.0, 150.0);
  StreetProfile wide;
  wide.lanes = 2;
  wide.front_garden = 3.0;
  kit.addMainStreet(wide, behind + kBusSpeed * duration + 90.0 + std::max(queue, 60.0));
  const double stop = behind + kEgoMiddle + 132.0;
  kit.main().kept_clear.push_back({stop - 22.0, stop + 12.0});
  kit.addSideStreets(behind + 60.0);
  kit.buildWorld();
  const Street& street = kit.main();
  const double right = street.profile.laneY(1);
  const double left = street.profile.laneY(0);
  const auto ego_path = std::make_shared<Path>(Path::through(
      {street.place(0.0, right), street.place(stop - 60.0, right), street.place(stop - 28.0, left),
       street.place(stop + 22.0, left), street.place(stop + 56.0, right), street.place(street.length, right)},
      300.0));
  kit.drive(ego_path, SpeedProfileBuilder(-1.0, kSpeed).keep(5.0).change(kSpeed + 0.4, 3.0).build(), behind);
  kit.shine(-0.8, 0.7, 0.15F);

  Traffic traffic = kit.traffic();
  const auto bus_path = std::make_shared<Path>(
      Path::through({street.place(0.0, left), street.place(stop - 62.0, left),
                     street.place(stop - 24.0, right), street.place(street.length, right)},
                    300.0));
  SpeedProfileBuilder bus(-1.0, kBusSpeed);
  const double bus_start = behind + kEgoMiddle + 2.0;
  bus.stopAfter(stop - bus_start + kBusSpeed, 42.0).keep(13.0).change(6.0, 5.0);
  traffic.addVehicle(kit.stock.buses.front(), bus_path, bus.build(), bus_start);
  for (int i = 0; i < 4; ++i)
    traffic.addStandingPerson(street.place(stop + kit.random.uniform(-4.0, 5.0),
                                           -street.profile.halfRoad() - kit.random.uniform(0.9, 1.6)),
                              kit.random.uniform(0.8, 2.2));
  const auto left_lane = kit.along(street, left);
  traffic.addPlatoon(kit.someCars(2), left_lane, SpeedProfile::constant(kBusSpeed), bus_start + 66.0, 1.6);
  for (int i = 0; i < 12; ++i)  // those who overtake later
    traffic.addVehicle(i % 2 == 0 ? kit.stock.buses.front() : pick(kit.stock.cars, kit.random), left_lane,
                       SpeedProfile::constant(kBusSpeed), behind - 30.0 - 9.0 * i);
  addOncoming(kit, traffic, 0, kOncoming, kHeadway);
  addOncoming(kit, traffic, 1, 9.0, kHeadway + 1.0);
  traffic.populatePavements(street, behind, behind + kSpeed * duration + 90.0, 16.0);
}

}  // namespace radar_dot::simulation
