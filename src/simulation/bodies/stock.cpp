// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/stock.h"

#include <utility>

#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kLength = static_cast<float>(Stock::kBoundaryLength);

/// A clipped hedge: its skin is uneven, so that it has no straight outline.
std::shared_ptr<const Mesh> makeHedge(RandomStream& random) {
  MeshBuilder builder;
  builder.use({Material::kFoliage, Color(0.09F, 0.17F, 0.05F)});
  constexpr int kRows = 9;
  constexpr int kColumns = 9;
  static constexpr float kProfile[kColumns][2] = {{0.30F, 0.0F},  {0.34F, 0.4F},  {0.33F, 0.9F},
                                                  {0.24F, 1.18F}, {0.0F, 1.25F},  {-0.24F, 1.18F},
                                                  {-0.33F, 0.9F}, {-0.34F, 0.4F}, {-0.30F, 0.0F}};
  std::vector<Vector3f> points;
  for (int row = 0; row < kRows; ++row) {
    for (const auto& [y, z] : kProfile) {
      // Both ends have the same outline, so that pieces join.
      const bool inside = row > 0 && row + 1 < kRows && z > 0.0F;
      const auto jitter = [&] { return inside ? static_cast<float>(random.normal(0.0, 0.03)) : 0.0F; };
      points.emplace_back(kLength * static_cast<float>(row) / (kRows - 1), y + jitter(), z + jitter());
    }
  }
  builder.sheet(points, kColumns, false);
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeFence() {
  MeshBuilder builder;
  builder.use({Material::kWood, Color(0.32F, 0.22F, 0.13F)});
  builder.box({0.0F, -0.05F, 0.0F}, {0.1F, 0.05F, 1.35F});
  for (const float z : {0.35F, 1.05F}) builder.box({0.0F, -0.06F, z}, {kLength, -0.02F, z + 0.09F});
  for (int plank = 0; plank < 13; ++plank) {
    const float x = 0.04F + 0.154F * static_cast<float>(plank);
    builder.box({x, -0.02F, 0.08F}, {x + 0.11F, 0.005F, plank % 2 == 0 ? 1.25F : 1.28F});
  }
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeWall(const Color& color, Material material) {
  MeshBuilder builder;
  builder.use({material, color});
  builder.box({0.0F, -0.12F, 0.0F}, {kLength, 0.12F, 0.95F});
  builder.use({Material::kConcrete, Color::Constant(0.42F)});
  builder.box({0.0F, -0.16F, 0.95F}, {kLength, 0.16F, 1.02F});
  return share(std::move(builder));
}

template <typename Make>
auto several(int count, RandomStream& random, const Make& make) {
  std::vector<decltype(make(random))> models;
  for (int i = 0; i < count; ++i) models.push_back(make(random));
  return models;
}

Stock::House makeHouse(double width, double depth, int storeys, bool shop, RandomStream& random) {
  const Facade facade{width, depth, storeys, shop};
  return {makeBuilding(facade, random), facade};
}

}  // namespace

Stock::Stock(RandomStream random)
    : cars(several(8, random, makeCar)),
      vans(several(2, random, makeVan)),
      trucks(several(2, random, makeTruck)),
      buses(several(1, random, makeBus)),
      pedestrians(several(9, random, makePedestrian)),
      cyclists(several(4, random, makeCyclist)),
      bicycles(several(3, random, makeParkedBicycle)),
      trees(several(6, random, makeTree)),
      bushes(several(3, random, makeBush)),
      signs(several(4, random, makeTrafficSign)),
      street_lamp(makeStreetLamp(kLampHeight, kLampReach)),
      traffic_light(makeTrafficLight()),
      bollard(makeBollard()),
      bin(makeBin()),
      bench(makeBench()),
      railing(makeRailing(kRailingLength)) {
  for (const double width : {8.0, 10.0, 12.0, 14.0, 17.0, 20.0}) {
    houses.push_back(makeHouse(width, 11.0, 2 + random.index(3), false, random));
    houses.push_back(makeHouse(width, 12.0, 3 + random.index(4), random.chance(0.65), random));
  }
  for (const int storeys : {9, 12, 15}) towers.push_back(makeHouse(24.0, 18.0, storeys, false, random));
  boundaries = {makeHedge(random), makeHedge(random), makeFence(),
                makeWall(Color(0.36F, 0.18F, 0.12F), Material::kBrick),
                makeWall(Color(0.55F, 0.52F, 0.46F), Material::kPlaster)};
}

}  // namespace radar_dot::simulation
