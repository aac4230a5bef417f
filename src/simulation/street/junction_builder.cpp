// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kHalfPi = 1.5707963267948966;

/// The rounded corner of the pavement in the quadrant (sign_x, sign_y), between roads of these half widths.
void buildCorner(GroundBatch& ground, double half_x, double half_y, double sign_x, double sign_y) {
  constexpr int kSteps = 10;
  const Vector2d centre(sign_x * (half_x + kPavementWidth), sign_y * (half_y + kPavementWidth));
  const auto rim = [&](int step, double radius) {
    const double angle = kHalfPi * step / kSteps;
    return Vector2d(centre + radius * Vector2d(-sign_x * std::cos(angle), -sign_y * std::sin(angle)));
  };
  for (int i = 0; i < kSteps; ++i) {
    const auto ring = [&](const Surface& surface, double inner, double outer, double z) {
      ground.use(surface);
      ground.quad({rim(i, inner), rim(i + 1, inner), rim(i + 1, outer), rim(i, outer)}, z);
    };
    ring(kGutterSurface, kPavementWidth, kPavementWidth + kGutterWidth, 0.001);
    ring(kKerbSurface, kPavementWidth - kKerbWidth, kPavementWidth, kKerbHeight);
    ring(kPavementSurface, 0.01, kPavementWidth - kKerbWidth, kKerbHeight);
    ground.use(kKerbSurface);
    ground.wall(rim(i, kPavementWidth), rim(i + 1, kPavementWidth), -0.05, kKerbHeight);
  }
}

/// Stop line (or give-way marks) and traffic lights of the arm in direction `yaw` of the junction's
/// frame, for those who come in.
void buildArm(GroundBatch& ground, const Eigen::Isometry3d& T_map_from_arm, const StreetProfile& arm,
              double other_half, bool signals, const Stock& stock, World& world) {
  const double edge = arm.lanes * arm.lane_width + arm.cycle_lane;
  ground.use(kPaintSurface);
  if (!signals) {
    const double x = other_half + kPavementWidth + 0.3;
    for (double y = 0.2; y + 0.5 < edge; y += 0.9) ground.rectangle(x, x + 0.45, y, y + 0.5, kPaintHeight);
    return;
  }
  const double x = stopLineDistance(other_half);
  ground.rectangle(x, x + kStopLineWidth, 0.1, edge, kPaintHeight);
  for (int lane = 0; lane < arm.lanes; ++lane)
    for (const double ahead : {8.0, 24.0}) paintArrow(ground, x + ahead, -arm.laneY(lane), -1.0);
  // Who comes in drives against the arm's x axis: the lamps face outwards.
  const double kerb = arm.halfRoad() + 0.5;
  for (const Vector2d& place : {Vector2d(x - 0.5, kerb), Vector2d(other_half + kPavementWidth, -kerb)})
    putStatic(world, stock.traffic_light,
              T_map_from_arm * poseAt(place.x(), place.y(), kKerbHeight, 2.0 * kHalfPi));
}

}  // namespace

void buildJunction(const StreetPlan& plan, const Junction& junction, const Stock& stock, RandomStream random,
                   World& world) {
  const Street& main = plan.streets[junction.main];
  const Street& cross = plan.streets[junction.cross];
  const double half_x = cross.profile.halfRoad();
  const double half_y = main.profile.halfRoad();
  const Eigen::Isometry3d T_map_from_junction =
      main.T_map_from_street * Eigen::Translation3d(junction.on_main, 0.0, 0.0);
  GroundBatch ground(T_map_from_junction);
  ground.use(kAsphaltSurface);
  const double reach_x = half_x + kPavementWidth;
  const double reach_y = half_y + kPavementWidth;
  for (int i = 0; i < 3; ++i)
    ground.strip(-reach_x, reach_x, reach_y * (2.0 * i / 3.0 - 1.0), reach_y * (2.0 * (i + 1) / 3.0 - 1.0),
                 0.0);
  layWear(ground, {-reach_x, reach_x}, half_y, random);
  for (const double sign_x : {-1.0, 1.0})
    for (const double sign_y : {-1.0, 1.0}) buildCorner(ground, half_x, half_y, sign_x, sign_y);
  ground.moveTo(world);
  for (int arm = 0; arm < 4; ++arm) {
    const bool along_main = arm % 2 == 0;
    if (!junction.signals && along_main) continue;  // has the right of way
    const Eigen::Isometry3d T_map_from_arm = T_map_from_junction * poseAt(0.0, 0.0, 0.0, kHalfPi * arm);
    GroundBatch paint(T_map_from_arm);
    buildArm(paint, T_map_from_arm, along_main ? main.profile : cross.profile, along_main ? half_x : half_y,
             junction.signals, stock, world);
    paint.moveTo(world);
  }
}

}  // namespace radar_dot::simulation
