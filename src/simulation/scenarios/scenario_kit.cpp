// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/scenario_kit.h"

#include <cmath>

namespace radar_dot::simulation {

void ScenarioKit::addMainStreet(const StreetProfile& profile, double length) {
  Street street;
  street.T_map_from_street = poseAt(0.0, 0.0, 0.0, heading) * Eigen::Translation3d(-0.5 * length, 0.0, 0.0);
  street.length = length;
  street.profile = profile;
  plan.streets.push_back(street);
}

void ScenarioKit::addSideStreets(double first) {
  constexpr double kArm = 110.0;  // m
  for (double x = first; x < main().length - 60.0; x += random.uniform(110.0, 150.0)) {
    Street side;
    side.length = 2.0 * kArm;
    side.profile.lane_width = 2.9;
    plan.cross(0, x, side, kArm, false);
  }
}

std::shared_ptr<const Path> ScenarioKit::along(const Street& street, double y, bool backwards) const {
  Eigen::Vector2d from = street.place(0.0, y);
  Eigen::Vector2d to = street.place(street.length, y);
  if (backwards) std::swap(from, to);
  return std::make_shared<Path>(Path::through({from, to}, 10.0));
}

void ScenarioKit::drive(const std::shared_ptr<const Path>& path, const SpeedProfile& profile, double start) {
  ego = std::make_shared<SprungTrajectory>(path, profile, start, seed);
}

void ScenarioKit::parkBicycles(Traffic& traffic, const Street& street, double low, double high,
                               double spacing) {
  for (const double side : {-1.0, 1.0}) {
    for (double x = low + random.uniform(0.0, spacing); x < high; x += spacing * random.uniform(0.6, 1.4)) {
      const double y = side * (street.profile.halfRoad() + kPavementWidth - 0.33);
      const Eigen::Vector2d place = street.place(x, y);
      if (plan.groundHeight(place) < kKerbHeight) continue;
      const std::shared_ptr<const Model>& model = pick(stock.bicycles, random);
      const Palette palette = randomPalette(*model, random);
      const double yaw = random.uniform(-0.06, 0.06);
      traffic.add({model,
                   std::make_shared<Standing>(street.T_map_from_street * poseAt(x, y, kKerbHeight, yaw)),
                   palette, true});
    }
  }
}

Stock::Models ScenarioKit::someCars(int count) {
  Stock::Models models;
  for (int i = 0; i < count; ++i)
    models.push_back(random.chance(0.85) ? pick(stock.cars, random) : pick(stock.vans, random));
  return models;
}

void addCrossers(Traffic& traffic, const Street& street, double zebra, double from_time, double to_time,
                 int attempts) {
  RandomStream& random = traffic.random();
  for (int i = 0; i < attempts; ++i) {
    const bool from_right = random.chance(0.5);  // keeps to the right
    const double x = zebra + (from_right ? 1.0 : -1.0) * random.uniform(0.3, 1.4);
    traffic.addCrossing(street, x, from_right, random.uniform(from_time, to_time), random.uniform(1.0, 1.7));
  }
}

void ScenarioKit::shine(double azimuth, double elevation, float grey) {
  Lighting& lighting = world.lighting;
  azimuth += heading;
  lighting.to_sun = Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                        .cast<float>();
  lighting.sun *= 1.0F - 0.8F * grey;
  const Color cloud = Color(0.72F, 0.74F, 0.77F);
  lighting.zenith = (1.0F - grey) * lighting.zenith + grey * cloud;
  lighting.horizon = (1.0F - grey) * lighting.horizon + grey * 1.05F * cloud;
  lighting.visibility = 1500.0F - 900.0F * grey;
}

}  // namespace radar_dot::simulation
