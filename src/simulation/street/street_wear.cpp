// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kCoverHeight = 0.003;  // m
const Surface kIron = {Material::kPaintedMetal, Color(0.09F, 0.085F, 0.08F)};

Surface asphaltLike(double brightness) {
  return {Material::kAsphalt, kAsphaltSurface.color * static_cast<float>(brightness)};
}

void layRepairs(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random) {
  for (double x = stretch.low + random.uniform(2.0, 10.0); x + 7.0 < stretch.high;
       x += random.uniform(5.0, 18.0)) {
    const double y = random.uniform(-reach, reach);
    ground.use(asphaltLike(random.chance(0.7) ? random.uniform(0.55, 0.8) : random.uniform(1.25, 1.5)));
    const double width = random.chance(0.3) ? 0.5 : random.uniform(0.8, 2.4);
    const double low = std::max(-reach, y - 0.5 * width);
    ground.rectangle(x, x + random.uniform(1.0, 6.0), low, std::min(reach, low + width), kPatchHeight);
  }
}

/// Narrow trenches across the whole road.
void layTrenches(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random) {
  for (double x = stretch.low + random.uniform(8.0, 40.0); x + 2.0 < stretch.high;
       x += random.uniform(30.0, 80.0)) {
    ground.use(asphaltLike(random.uniform(0.65, 0.85)));
    const double skew = random.uniform(-0.8, 0.8);
    const double width = random.uniform(0.45, 0.9);
    ground.quad({Vector2d(x, -reach), {x + width, -reach}, {x + width + skew, reach}, {x + skew, reach}},
                kPatchHeight - 0.0005);
  }
}

/// Cracks filled with tar: thin lines that wander along or across the road.
void sealCracks(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random) {
  ground.use({Material::kAsphalt, Color::Constant(0.035F)});
  for (double x = stretch.low + random.uniform(0.0, 10.0); x < stretch.high; x += random.uniform(4.0, 14.0)) {
    Vector2d place(x, random.uniform(-reach, reach));
    double heading = random.chance(0.6) ? random.normal(0.0, 0.15) : random.normal(1.57, 0.2);
    const double half_width = random.uniform(0.015, 0.03);
    const int steps = 6 + random.index(14);
    for (int i = 0; i < steps; ++i) {
      heading += random.normal(0.0, 0.25);
      const Vector2d next = place + 0.45 * Vector2d(std::cos(heading), std::sin(heading));
      if (std::abs(next.y()) > reach || next.x() < stretch.low || next.x() > stretch.high) break;
      const Vector2d across = half_width * Vector2d(-std::sin(heading), std::cos(heading));
      ground.quad({Vector2d(place - across), next - across, next + across, place + across},
                  kCoverHeight - 0.0005);
      place = next;
    }
  }
}

void layCovers(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random) {
  for (double x = stretch.low + random.uniform(3.0, 20.0); x + 1.0 < stretch.high;
       x += random.uniform(14.0, 40.0)) {
    const double y = random.uniform(0.4 - reach, reach - 0.4);
    ground.use(asphaltLike(0.7));
    ground.rectangle(x - 0.5, x + 0.5, y - 0.5, y + 0.5, kPatchHeight + 0.0002);
    ground.use(kIron);
    ground.disc({x, y}, 0.31, kCoverHeight);
  }
}

void layPavementDetails(GroundBatch& ground, const Street& street, const Street::Gap& stretch,
                        RandomStream& random) {
  const double inner = street.profile.halfRoad() + kKerbWidth + 0.1;
  const double outer = street.profile.halfRoad() + kPavementWidth - 0.1;
  for (double x = stretch.low + random.uniform(1.0, 8.0); x + 5.0 < stretch.high;
       x += random.uniform(5.0, 14.0)) {
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const double from = random.uniform(inner, outer - 0.6);
    const double to = std::min(outer, from + random.uniform(0.5, 1.8));
    const double length = random.chance(0.3) ? 0.7 : random.uniform(0.8, 4.0);
    if (random.chance(0.35))
      ground.use(asphaltLike(random.uniform(0.9, 1.3)));
    else if (random.chance(0.25))
      ground.use(kIron);
    else
      ground.use(
          {Material::kPavement, kPavementSurface.color * static_cast<float>(random.uniform(0.7, 1.25))});
    ground.rectangle(x, x + length, std::min(side * from, side * to), std::max(side * from, side * to),
                     kKerbHeight + kPatchHeight);
  }
}

}  // namespace

void layWear(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random) {
  layTrenches(ground, stretch, reach, random);
  layRepairs(ground, stretch, reach, random);
  sealCracks(ground, stretch, reach, random);
  layCovers(ground, stretch, reach, random);
}

void buildWear(const Street& street, RandomStream random, World& world) {
  GroundBatch ground(street.T_map_from_street);
  const double reach = street.profile.halfRoad() - kGutterWidth - 0.1;
  const double drain = street.profile.halfRoad() - 0.5 * kGutterWidth;
  for (const Street::Gap& stretch : Street::free(0.0, street.length, street.junctions)) {
    layWear(ground, stretch, reach, random);
    layPavementDetails(ground, street, stretch, random);
    ground.use(kIron);
    for (double x = stretch.low + 6.0; x + 1.0 < stretch.high; x += 24.0)
      for (const double side : {-1.0, 1.0})
        ground.rectangle(x, x + 0.5, side * drain - 0.14, side * drain + 0.14, kCoverHeight);
  }
  ground.moveTo(world);
}

}  // namespace radar_dot::simulation
