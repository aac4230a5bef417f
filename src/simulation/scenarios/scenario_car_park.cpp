// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "simulation/scenarios/scenario_kit.h"

namespace radar_dot::simulation {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kBayWidth = 2.5;  // m
constexpr double kBayDepth = 5.0;  // m
constexpr double kAisle = 6.6;     // m, width
constexpr double kPitch = kAisle + 2.0 * kBayDepth;
constexpr int kBays = 24;   // of a row
constexpr int kIsland = 8;  // every so many bays there is a tree instead
constexpr int kAisles = 5;
constexpr double kRowLength = kBays * kBayWidth;
constexpr double kEndLane = kAisle + kBayDepth;  // m, lanes that join the aisles, and bays beyond them
constexpr double kDepth = kAisles * kPitch;
constexpr int kEndBays = 30;  // of the rows across the ends
constexpr double kEndBayBegin = 0.5 * (kDepth - kEndBays * kBayWidth);

double aisleY(int aisle) { return (aisle + 0.5) * kPitch; }

bool isIsland(int bay) { return bay % kIsland == 4; }

// Frame of the car park: the rows reach from x = 0 to kRowLength, y from 0 to kDepth.

void layGround(GroundBatch& ground) {
  ground.use(kAsphaltSurface);
  for (int i = 0; i < 2 * kAisles; ++i)
    ground.strip(-kEndLane, kRowLength + kEndLane, 0.5 * kPitch * i, 0.5 * kPitch * (i + 1), 0.0);
  const auto border = [&](const Surface& surface, double inner, double outer, double z) {
    ground.use(surface);
    const double low = -kEndLane, high = kRowLength + kEndLane;
    ground.strip(low - outer, high + outer, -outer, -inner, z);
    ground.strip(low - outer, high + outer, kDepth + inner, kDepth + outer, z);
    ground.rectangle(low - outer, low - inner, -inner, kDepth + inner, z);
    ground.rectangle(high + inner, high + outer, -inner, kDepth + inner, z);
  };
  border(kKerbSurface, 0.0, kKerbWidth, kKerbHeight);
  border(kGrassSurface, kKerbWidth, 3.0, kPlotHeight);
  border(kPavementSurface, 3.0, 6.0, kKerbHeight);
  border(kGrassSurface, 6.0, 40.0, kPlotHeight);
  ground.use(kKerbSurface);
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(-kEndLane, 0.0),
                                                  {kRowLength + kEndLane, 0.0},
                                                  {kRowLength + kEndLane, kDepth},
                                                  {-kEndLane, kDepth}};
  for (std::size_t i = 0; i < 4; ++i) ground.wall(corners[i], corners[(i + 1) % 4], -0.05, kKerbHeight);
  ground.use(kPaintSurface);
  for (int aisle = 0; aisle < kAisles; ++aisle) {
    for (const double side : {-1.0, 1.0}) {
      const double inner = aisleY(aisle) + side * 0.5 * kAisle;
      const double outer = inner + side * kBayDepth;
      for (int bay = 0; bay <= kBays; ++bay)
        ground.rectangle(bay * kBayWidth - 0.05, bay * kBayWidth + 0.05, std::min(inner, outer),
                         std::max(inner, outer), kPaintHeight);
    }
    for (double x = 9.0; x < kRowLength; x += 20.0)
      paintArrow(ground, x, aisleY(aisle), aisle % 2 == 0 ? 1.0 : -1.0);
  }
  for (int bay = 0; bay <= kEndBays; ++bay) {
    const double y = kEndBayBegin + bay * kBayWidth;
    ground.rectangle(-kEndLane, -kAisle, y - 0.05, y + 0.05, kPaintHeight);
    ground.rectangle(kRowLength + kAisle, kRowLength + kEndLane, y - 0.05, y + 0.05, kPaintHeight);
  }
}

/// A kerbed bed with a tree, where a bay of each of two rows would be.
void layIsland(ScenarioKit& kit, const Eigen::Isometry3d& T_map_from_park, GroundBatch& ground, double x,
               double y0, double y1) {
  const double low = x + 0.25, high = x + kBayWidth - 0.25;
  ground.use(kKerbSurface);
  ground.rectangle(low, high, y0, y1, kKerbHeight);
  for (const auto& [from, to] : {std::pair<Eigen::Vector2d, Eigen::Vector2d>{{low, y0}, {high, y0}},
                                 {{high, y0}, {high, y1}},
                                 {{high, y1}, {low, y1}},
                                 {{low, y1}, {low, y0}}})
    ground.wall(from, to, 0.0, kKerbHeight);
  ground.use({Material::kSoil, Color(0.13F, 0.09F, 0.06F)});
  ground.rectangle(low + 0.12, high - 0.12, y0 + 0.12, y1 - 0.12, kKerbHeight + 0.003);
  const double middle = 0.5 * (low + high);
  const auto put = [&](const std::shared_ptr<const Mesh>& mesh, double y) {
    putStatic(kit.world, mesh,
              T_map_from_park * poseAt(middle, y, kKerbHeight, kit.random.uniform(-kPi, kPi)));
  };
  put(pick(kit.stock.trees, kit.random), 0.5 * (y0 + y1));
  for (double y = y0 + 1.2; y < y1 - 1.0; y += 1.7)
    if (std::abs(y - 0.5 * (y0 + y1)) > 0.9) put(pick(kit.stock.bushes, kit.random), y);
}

void parkCar(ScenarioKit& kit, Traffic& traffic, const Eigen::Isometry3d& T_map_from_park, double x, double y,
             double yaw) {
  RandomStream& random = kit.random;
  const std::shared_ptr<const Model>& model = pick(kit.stock.cars, random);
  const Palette palette = randomPalette(*model, random);
  const Eigen::Isometry3d pose =
      T_map_from_park * poseAt(x + random.uniform(-0.1, 0.1), y + random.uniform(-0.1, 0.1), 0.0,
                               yaw + (random.chance(0.3) ? kPi : 0.0) + random.normal(0.0, 0.02));
  traffic.add({model, std::make_shared<Standing>(pose), palette, true});
}

void parkInBays(ScenarioKit& kit, Traffic& traffic, const Eigen::Isometry3d& T_map_from_park) {
  for (int aisle = 0; aisle < kAisles; ++aisle) {
    for (const double side : {-1.0, 1.0}) {
      const double share = kit.random.uniform(0.55, 0.85);
      for (int bay = 0; bay < kBays; ++bay)
        if (!isIsland(bay) && kit.random.chance(share))
          parkCar(kit, traffic, T_map_from_park, (bay + 0.5) * kBayWidth,
                  aisleY(aisle) + side * 0.5 * (kAisle + kBayDepth), side * 0.5 * kPi);
    }
  }
  for (int bay = 0; bay < kEndBays; ++bay) {
    const double y = kEndBayBegin + (bay + 0.5) * kBayWidth;
    if (kit.random.chance(0.7))
      parkCar(kit, traffic, T_map_from_park, kRowLength + kAisle + 0.5 * kBayDepth, y, 0.0);
    if (kit.random.chance(0.7)) parkCar(kit, traffic, T_map_from_park, -kAisle - 0.5 * kBayDepth, y, kPi);
  }
}

void surround(ScenarioKit& kit, const Eigen::Isometry3d& T_map_from_park) {
  const double low = -kEndLane, high = kRowLength + kEndLane;
  struct Side {
    Eigen::Isometry3d pose;  // x along the edge, y inwards
    double length;
  };
  const Side sides[] = {{poseAt(low, 0.0, 0.0, 0.0), high - low},
                        {poseAt(high, 0.0, 0.0, 0.5 * kPi), kDepth},
                        {poseAt(high, kDepth, 0.0, kPi), high - low},
                        {poseAt(low, kDepth, 0.0, -0.5 * kPi), kDepth}};
  for (const Side& side : sides) {
    const Eigen::Isometry3d T_map_from_side = T_map_from_park * side.pose;
    for (double x = 0.0; x + Stock::kBoundaryLength <= side.length; x += Stock::kBoundaryLength)
      putStatic(kit.world, kit.stock.boundaries[kit.random.index(2) == 0 ? 0 : 1],
                T_map_from_side * poseAt(x, -1.8, kPlotHeight, 0.0));
    for (double x = 6.0; x < side.length; x += 17.0)
      putStatic(kit.world, kit.stock.street_lamp, T_map_from_side * poseAt(x, -0.7, kPlotHeight, 0.5 * kPi));
    for (double x = 11.0; x < side.length; x += kit.random.uniform(8.0, 14.0))
      putStatic(kit.world, pick(kit.stock.trees, kit.random),
                T_map_from_side * poseAt(x, -4.4, kKerbHeight, kit.random.uniform(-kPi, kPi)));
    buildHouseRow(T_map_from_side * poseAt(-14.0, -9.0, kPlotHeight, 0.0), side.length + 20.0, 3.0, kit.stock,
                  kit.random, kit.world);
  }
}

}  // namespace

void makeCarPark(ScenarioKit& kit) {
  const Eigen::Isometry3d T_map_from_area = poseAt(0.0, 0.0, 0.0, kit.heading);
  const Eigen::Isometry3d T_map_from_park =
      T_map_from_area * Eigen::Translation3d(-0.5 * kRowLength, -0.5 * kDepth, 0.0);
  const auto place = [&](double x, double y) {
    return Eigen::Vector2d((T_map_from_park * Eigen::Vector3d(x, y, 0.0)).head<2>());
  };
  const double left = -0.5 * kAisle, right = kRowLength + 0.5 * kAisle;
  std::vector<Eigen::Vector2d> waypoints = {place(-2.0, aisleY(0))};
  for (int aisle = 0; aisle < kAisles; ++aisle) {
    const double x = aisle % 2 == 0 ? right : left;
    waypoints.push_back(place(x, aisleY(aisle)));
    if (aisle + 1 < kAisles) waypoints.push_back(place(x, aisleY(aisle + 1)));
  }
  SpeedProfileBuilder drive(-1.0, 2.7);
  drive.keep(2.0).change(2.3, 2.5).keep(6.0);
  while (drive.time() < kit.duration_s + 5.0)
    drive.change(kit.random.uniform(2.1, 3.0), 2.5).keep(kit.random.uniform(1.0, 5.0));
  kit.drive(std::make_shared<Path>(Path::through(waypoints, 5.0)), drive.build(), 31.0);
  kit.shine(0.8, 0.9, 0.2F);

  GroundBatch ground(T_map_from_park);
  layGround(ground);
  for (int row = 0; row <= kAisles; ++row) {
    const double y0 = row == 0 ? 0.25 : row * kPitch - kBayDepth + 0.25;
    const double y1 = row == kAisles ? kDepth - 0.25 : row * kPitch + kBayDepth - 0.25;
    for (int bay = 0; bay < kBays; ++bay)
      if (isIsland(bay)) layIsland(kit, T_map_from_park, ground, bay * kBayWidth, y0, y1);
  }
  ground.moveTo(kit.world);
  for (int aisle = 0; aisle < kAisles; ++aisle) {
    GroundBatch wear(T_map_from_park * Eigen::Translation3d(0.0, aisleY(aisle), 0.0));
    layWear(wear, {-kEndLane, kRowLength + kEndLane}, 0.5 * kPitch, kit.random);
    wear.moveTo(kit.world);
  }
  surround(kit, T_map_from_park);
  buildSurroundings(T_map_from_area, {0.5 * kRowLength + kEndLane + 12.0, 0.5 * kDepth + 12.0}, kit.stock,
                    RandomStream(kit.seed, 50), kit.world);
  Traffic traffic = kit.traffic();
  parkInBays(kit, traffic, T_map_from_park);
}

}  // namespace radar_dot::simulation
