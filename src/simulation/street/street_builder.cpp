// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

constexpr double kPi = 3.141592653589793;

/// Trees and towers behind the gardens, on a ring around the streets.
void buildSkyline(const Eigen::Isometry3d& T_map_from_area, const Eigen::Vector2d& half, const Stock& stock,
                  RandomStream& random, World& world) {
  /// Calls place(pose) along the ring; x of the pose runs along it, y inwards.
  const auto onRing = [&](double margin, double spacing, const auto& place) {
    for (int side = 0; side < 4; ++side) {
      const Eigen::Vector2d reach = half.array() + margin;
      const double along = side % 2 == 0 ? reach.x() : reach.y();
      const double outward = side % 2 == 0 ? reach.y() : reach.x();
      const Eigen::Isometry3d T_map_from_side = T_map_from_area * poseAt(0.0, 0.0, 0.0, 0.5 * kPi * side);
      for (double x = -along; x < along; x += spacing * random.uniform(0.7, 1.3))
        place(Eigen::Isometry3d(T_map_from_side * poseAt(x, -outward, -0.05, 0.0)));
    }
  };
  onRing(75.0, 70.0, [&](const Eigen::Isometry3d& pose) {  // the fronts look inwards
    putStatic(world, pick(stock.towers, random).mesh, pose);
  });
  onRing(45.0, 9.0, [&](const Eigen::Isometry3d& pose) {
    putStatic(
        world, pick(stock.trees, random),
        pose * poseAt(random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0), 0.0, random.uniform(-kPi, kPi)));
  });
}

}  // namespace

void buildSurroundings(const Eigen::Isometry3d& T_map_from_area, const Eigen::Vector2d& half,
                       const Stock& stock, RandomStream random, World& world) {
  constexpr double kReach = 600.0;  // m
  constexpr double kTile = 150.0;
  GroundBatch ground(T_map_from_area);
  ground.use({Material::kGrass, Color(0.14F, 0.17F, 0.07F)});
  const Eigen::Vector2d reach = half.array() + kReach;
  for (double x = -reach.x(); x < reach.x(); x += kTile)
    for (double y = -reach.y(); y < reach.y(); y += kTile)
      ground.rectangle(x, x + kTile, y, y + kTile, -0.05);
  ground.moveTo(world);
  buildSkyline(T_map_from_area, half, stock, random, world);
}

void buildStreets(const StreetPlan& plan, const Stock& stock, std::uint64_t seed, World& world) {
  const Eigen::Isometry3d& T_map_from_main = plan.streets.front().T_map_from_street;
  Eigen::AlignedBox2d extent;  // in the frame of the first street
  std::uint64_t stream = 100;
  for (const Street& street : plan.streets) {
    buildRoad(street, world);
    buildWear(street, RandomStream(seed, ++stream), world);
    buildMarkings(street, world);
    buildHouses(street, stock, RandomStream(seed, ++stream), world);
    buildFurniture(street, stock, RandomStream(seed, ++stream), world);
    parkCars(street, stock, RandomStream(seed, ++stream), world);
    const double side = street.profile.houseLine();
    for (const double x : {0.0, street.length})
      for (const double y : {-side, side})
        extent.extend(
            (T_map_from_main.inverse() * street.T_map_from_street * Eigen::Vector3d(x, y, 0.0)).head<2>());
  }
  for (const Junction& junction : plan.junctions)
    buildJunction(plan, junction, stock, RandomStream(seed, ++stream), world);
  const Eigen::Isometry3d T_map_from_area =
      T_map_from_main * poseAt(extent.center().x(), extent.center().y(), 0.0, 0.0);
  buildSurroundings(T_map_from_area, 0.5 * extent.sizes(), stock, RandomStream(seed, ++stream), world);
}

}  // namespace radar_dot::simulation
