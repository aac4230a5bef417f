// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/scenarios/scenario_kit.h"

namespace radar_dot::simulation {
namespace {

constexpr double kEgoFront = 3.3;  // m ahead of base_link

/// Vehicles that wait at a stop line of `street`, the foremost with its middle `start` m along its path.
void addWaiting(ScenarioKit& kit, Traffic& traffic, const std::shared_ptr<const Path>& path, double start,
                int count) {
  traffic.addPlatoon(kit.someCars(count), path, SpeedProfile::constant(0.0), start, 1.0);
}

}  // namespace

void makeCrossing(ScenarioKit& kit) {
  const double duration = kit.duration_s;
  constexpr double kCruise = 8.5, kTurnSpeed = 3.8, kArm = 130.0, kOncoming = 8.0, kHeadway = 3.2;
  kit.addMainStreet({}, 2.0 * kArm);
  Street cross;
  const double queue = Traffic::queueLength(duration, kOncoming, kHeadway);
  const double south = 120.0 + queue;
  const double north = 150.0 + kCruise * duration + queue;
  cross.length = south + north;
  kit.plan.cross(0, kArm, cross, south, true);
  // The long street in the middle of the map.
  for (Street& street : kit.plan.streets)
    street.T_map_from_street.pretranslate(poseAt(0.0, 0.0, 0.0, kit.heading) *
                                          Eigen::Vector3d(0.0, -0.5 * (north - south), 0.0));
  const Street& main = kit.plan.streets[0];
  const Street& long_street = kit.plan.streets[1];
  kit.buildWorld();

  const double lane = main.profile.laneY();
  const Eigen::Vector2d corner = main.place(kArm - lane, lane);
  const auto turn = std::make_shared<Path>(Path::through(
      {main.place(0.0, lane), corner, long_street.place(long_street.length, long_street.profile.laneY())},
      7.5));
  const double start = kArm - lane - 23.5;
  SpeedProfileBuilder drive(-4.0, 7.0);
  drive.change(4.6, 4.0).change(kTurnSpeed, 2.0).keep(4.2).change(kCruise, 5.0);
  kit.drive(turn, drive.build(), start);
  kit.shine(-2.2, 0.75, 0.1F);

  Traffic traffic = kit.traffic();
  // Everybody takes the bend as slowly as the ego does: they differ in time only.
  constexpr double kApart = 2.1;  // s
  const auto join = [&](const std::shared_ptr<const Model>& model, double delay) {
    traffic.addVehicle(model, turn, kit.ego->profile().delayed(delay),
                       kit.ego->along(-delay) - model->rear_axle_x);
  };
  join(kit.stock.vans.front(), -kApart);
  for (int i = 0; i < 2; ++i) join(pick(kit.stock.cars, kit.random), (i + 1) * kApart);
  const double half = main.profile.halfRoad();
  const double stop = stopLineDistance(half) + 0.5 + 2.3;
  addWaiting(kit, traffic, kit.along(main, -lane, true), kArm - stop, 3);
  addWaiting(kit, traffic, kit.along(long_street, lane), south - stop, 3);
  const auto southward = kit.along(long_street, -lane, true);
  SpeedProfileBuilder wait(11.0, 0.0);
  wait.change(kOncoming, 3.5).stopAfter(south + stop - 14.0, 14.0);
  traffic.addPlatoon(kit.someCars(4), southward, wait.build(), north - stop, 1.3);
  const double end = north + 60.0 + queue;
  traffic.addStream(southward, {queue, end, kOncoming, kHeadway, (end - (north - 170.0)) / kOncoming});

  const double zebra = zebraDistance(half);
  addCrossers(traffic, long_street, south + zebra, -9.0, -3.0, 24);
  addCrossers(traffic, long_street, south - zebra, -9.0, 4.0, 12);
  addCrossers(traffic, long_street, south + zebra, 6.0, 14.0, 6);
  traffic.populatePavements(main, 60.0, 200.0, 11.0);
  traffic.populatePavements(long_street, south - 40.0, south + kCruise * duration + 110.0, 13.0);
  kit.parkBicycles(traffic, long_street, south, south + kCruise * duration + 80.0, 30.0);
}

void makeStanding(ScenarioKit& kit) {
  constexpr double kArm = 140.0, kSpeed = 9.0, kHeadway = 1.7;
  StreetProfile wide;
  wide.lanes = 2;
  wide.parking = 0.0;
  kit.addMainStreet(wide, 2.0 * kArm);
  Street cross;
  cross.profile.parking = 0.0;
  cross.profile.front_garden = 1.0;
  const double queue = Traffic::queueLength(kit.duration_s, kSpeed, kHeadway);
  cross.length = 2.0 * (70.0 + queue);
  const double middle = 0.5 * cross.length;
  kit.plan.cross(0, kArm, cross, middle, true);
  const Street& main = kit.plan.streets[0];
  const Street& busy = kit.plan.streets[1];
  kit.buildWorld();

  const double stop = stopLineDistance(busy.profile.halfRoad());
  const auto lane = kit.along(main, main.profile.laneY(0));
  kit.drive(lane, SpeedProfile::constant(0.0), kArm - stop - 0.9 - kEgoFront);
  kit.shine(2.4, 0.6, 0.35F);

  Traffic traffic = kit.traffic();
  for (const bool backwards : {false, true}) {
    const auto path = kit.along(busy, (backwards ? -1.0 : 1.0) * busy.profile.laneY(), backwards);
    traffic.addStream(path, {queue, busy.length - 12.0, kSpeed, kHeadway, 0.0});
  }
  traffic.addPlatoonWithEgo({}, kit.someCars(2), lane, *kit.ego, 1.0);
  addWaiting(kit, traffic, kit.along(main, main.profile.laneY(1)), kArm - stop - 3.4, 2);
  for (const int number : {0, 1})
    addWaiting(kit, traffic, kit.along(main, -main.profile.laneY(number), true), kArm - stop - 3.0, 3);
  const double zebra = zebraDistance(busy.profile.halfRoad());
  const int crossers = 12 + static_cast<int>(1.5 * kit.duration_s);
  addCrossers(traffic, main, kArm - zebra, -12.0, kit.duration_s, crossers);
  addCrossers(traffic, main, kArm + zebra, -12.0, kit.duration_s, crossers);
  traffic.populatePavements(main, 90.0, 2.0 * kArm - 30.0, 9.0);
  traffic.populatePavements(busy, middle - 70.0, middle + 70.0, 9.0);
  kit.parkBicycles(traffic, main, kArm - 30.0, kArm + 60.0, 14.0);
}

}  // namespace radar_dot::simulation
