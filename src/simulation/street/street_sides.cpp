// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kBoundaryOffset = 0.45;  // m, of fences from the pavement
constexpr double kFurnitureBand = 0.55;   // m behind the kerb's edge

bool isClear(const std::vector<Street::Gap>& gaps, double low, double high) {
  return std::none_of(gaps.begin(), gaps.end(),
                      [&](const Street::Gap& gap) { return gap.low < high && low < gap.high; });
}

std::vector<Street::Gap> clearGaps(const Street& street, double around_zebra) {
  std::vector<Street::Gap> gaps = street.kept_clear;
  for (const double x : street.zebras) gaps.push_back({x - around_zebra, x + around_zebra});
  return gaps;
}

void boundary(const Eigen::Isometry3d& T_map_from_row, double from, double to, double y, const Stock& stock,
              RandomStream& random, World& world) {
  const auto& piece = pick(stock.boundaries, random);
  for (double x = from; x + Stock::kBoundaryLength <= to; x += Stock::kBoundaryLength)
    putStatic(world, piece, T_map_from_row * poseAt(x, y, 0.0, 0.0));
}

void garden(const Eigen::Isometry3d& T_map_from_row, double from, double to, double depth, const Stock& stock,
            RandomStream& random, World& world) {
  // The door is in the middle of the front, or half a window to the right.
  const double middle = 0.5 * (from + to) + 0.65;
  const double front = depth - kBoundaryOffset;
  boundary(T_map_from_row, from, middle - 1.35, front, stock, random, world);
  boundary(T_map_from_row, middle + 1.35, to, front, stock, random, world);
  if (depth < 2.0) return;
  for (double x = from + 0.8; x < to - 0.8; x += random.uniform(1.6, 4.0))
    if (std::abs(x - middle) > 1.9 && random.chance(0.6))
      putStatic(world, pick(stock.bushes, random),
                T_map_from_row * poseAt(x, 0.9, 0.0, random.uniform(-kPi, kPi)));
}

}  // namespace

Eigen::Isometry3d poseAt(double x, double y, double z, double yaw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() << x, y, z;
  return pose;
}

void buildHouseRow(const Eigen::Isometry3d& T_map_from_row, double length, double garden_depth,
                   const Stock& stock, RandomStream& random, World& world) {
  GroundBatch paving(T_map_from_row);
  paving.use(kPavementSurface);
  double x = 0.0;
  while (length - x > 8.0) {
    if (random.chance(0.22)) {  // a gap with a tree behind a fence
      const double gap = std::min(random.uniform(4.0, 9.0), length - x);
      boundary(T_map_from_row, x, x + gap, garden_depth - kBoundaryOffset, stock, random, world);
      for (const double depth : {random.uniform(-6.0, -2.5), random.uniform(-22.0, -14.0)})
        putStatic(world, pick(stock.trees, random),
                  T_map_from_row * poseAt(x + 0.5 * gap, depth, 0.0, random.uniform(-kPi, kPi)));
      x += gap;
      continue;
    }
    const Stock::House* house = &pick(stock.houses, random);
    if (house->facade.width > length - x) house = &stock.houses.front();
    const double width = house->facade.width;
    const bool planted = garden_depth > 1.5 && !house->facade.shop && random.chance(0.75);
    const double setback = planted && garden_depth > 2.0 ? random.uniform(-1.2, 0.0) : 0.0;
    putStatic(world, house->mesh, T_map_from_row * poseAt(x, setback, 0.0, 0.0));
    if (planted)
      garden(T_map_from_row, x + 0.1, x + width - 0.1, garden_depth, stock, random, world);
    else
      paving.strip(x, x + width, -0.5, garden_depth, kKerbHeight - kPlotHeight);
    x += width + (random.chance(0.5) ? 0.02 : random.uniform(1.0, 2.5));
  }
  paving.moveTo(world);
  boundary(T_map_from_row, x, length, garden_depth - kBoundaryOffset, stock, random, world);
}

void buildHouses(const Street& street, const Stock& stock, RandomStream random, World& world) {
  const StreetProfile& profile = street.profile;
  std::vector<Street::Gap> gaps = street.junctions;
  for (Street::Gap& gap : gaps) {
    const double corner = street.priority ? 0.8 : kPlotDepth - 12.0;
    gap.low -= corner;
    gap.high += corner;
  }
  for (const auto& [low, high] : Street::free(0.0, street.length, gaps)) {
    buildHouseRow(street.T_map_from_street * poseAt(low, -profile.houseLine(), kPlotHeight, 0.0), high - low,
                  profile.front_garden, stock, random, world);
    buildHouseRow(street.T_map_from_street * poseAt(high, profile.houseLine(), kPlotHeight, kPi), high - low,
                  profile.front_garden, stock, random, world);
  }
  const double reach = profile.houseLine() + 14.0;
  if (street.closed_end)
    buildHouseRow(street.T_map_from_street * poseAt(street.length + 7.0, -reach, kPlotHeight, 0.5 * kPi),
                  2.0 * reach, 2.0, stock, random, world);
  if (street.closed_start)
    buildHouseRow(street.T_map_from_street * poseAt(-7.0, reach, kPlotHeight, -0.5 * kPi), 2.0 * reach, 2.0,
                  stock, random, world);
}

void buildFurniture(const Street& street, const Stock& stock, RandomStream random, World& world) {
  const std::vector<Street::Gap> gaps = clearGaps(street, 3.0);
  const double band = street.profile.halfRoad() + kFurnitureBand;
  for (const double side : {-1.0, 1.0}) {
    // In the frame of the side x runs along the street and +y towards the road.
    const Eigen::Isometry3d T_map_from_side =
        street.T_map_from_street *
        (side < 0.0 ? poseAt(0.0, -band, kKerbHeight, 0.0) : poseAt(street.length, band, kKerbHeight, kPi));
    const auto put = [&](const std::shared_ptr<const Mesh>& mesh, double x, double yaw, double reach) {
      const double along = side < 0.0 ? x : street.length - x;
      if (!isClear(gaps, along - reach, along + reach)) return false;
      putStatic(world, mesh, T_map_from_side * poseAt(x, 0.0, 0.0, yaw));
      return true;
    };
    GroundBatch pits(T_map_from_side);
    pits.use({Material::kSoil, Color(0.13F, 0.095F, 0.06F)});
    constexpr double kLampSpacing = 28.0;
    const double first_lamp = side < 0.0 ? 8.0 : 8.0 + 0.5 * kLampSpacing;
    double tree = random.uniform(2.0, 8.0);
    for (double lamp = first_lamp; lamp < street.length; lamp += kLampSpacing) {
      put(stock.street_lamp, lamp, 0.5 * kPi, 1.0);
      put(pick(stock.signs, random), lamp + 5.0, random.chance(0.2) ? kPi : 0.0, 0.5);
      if (random.chance(0.5)) put(stock.bin, lamp + 1.2, 0.0, 0.5);
      if (random.chance(0.35)) put(stock.bench, lamp + 3.0, 0.0, 1.2);
      for (int i = 0; i < 3 && random.chance(0.5); ++i) put(stock.bollard, lamp + 7.0 + 1.5 * i, 0.0, 0.3);
      if (random.chance(0.25))
        for (int i = 0; i < 3; ++i)
          put(stock.railing, lamp - 11.0 + Stock::kRailingLength * i, 0.0, Stock::kRailingLength);
    }
    for (; tree < street.length; tree += random.uniform(9.0, 13.0)) {
      const double phase = std::fmod(tree - first_lamp + kLampSpacing, kLampSpacing);
      if (phase < 12.0 || phase > 26.0 || (phase > 15.5 && phase < 24.0 && random.chance(0.3))) continue;
      if (random.chance(street.tree_share) &&
          put(pick(stock.trees, random), tree, random.uniform(-kPi, kPi), 0.5))
        pits.rectangle(tree - 0.6, tree + 0.6, -0.6, 0.35, kPatchHeight);
    }
    pits.moveTo(world);
  }
}

void parkCars(const Street& street, const Stock& stock, RandomStream random, World& world) {
  if (street.profile.parking <= 0.0) return;
  const std::vector<Street::Gap> gaps = clearGaps(street, 6.0);
  for (const double side : {-1.0, 1.0}) {
    const double y = -side * street.profile.parkingY();
    double x = random.uniform(2.0, 6.0);
    while (x < street.length - 6.0) {
      const auto& model = random.chance(0.09) ? pick(stock.vans, random) : pick(stock.cars, random);
      const double length = model->size.x();
      if (!isClear(gaps, x, x + length)) {
        x += 1.0;
        continue;
      }
      if (random.chance(street.parked_share)) {
        const bool reversed = (side > 0.0) != random.chance(0.08);
        const double yaw = (reversed ? kPi : 0.0) + random.normal(0.0, 0.012);
        const double beside = std::clamp(random.normal(0.0, 0.06), -0.12, 0.12);
        const Eigen::Isometry3d pose =
            street.T_map_from_street * poseAt(x + 0.5 * length, y + beside, 0.0, yaw);
        world.actors.push_back(
            {model, std::make_shared<Standing>(pose), randomPalette(*model, random), true});
      }
      x += length + random.uniform(0.7, 1.6);
    }
  }
}

}  // namespace radar_dot::simulation
