// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "radar_dot/simulation/mesh.h"
#include "radar_dot/simulation/model.h"
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {

/// A static object: road, house, tree, pole.
struct StaticObject {
  std::shared_ptr<const Mesh> mesh;
  Eigen::Isometry3d T_map_from_object = Eigen::Isometry3d::Identity();
  Palette palette = plainPalette();
};

/// Something that may move: an annotated road user.
struct Actor {
  std::shared_ptr<const Model> model;
  std::shared_ptr<const Trajectory> trajectory;
  Palette palette = plainPalette();
  bool parked = false;  ///< without a driver, and never moves: "vehicle.parked" or "cycle.without_rider"
};

/// A lamp that shines downwards or ahead, at night.
struct Lamp {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();              ///< m, map frame
  Eigen::Vector3f direction = Eigen::Vector3f(0.0F, 0.0F, -1.0F);  ///< unit
  Color intensity = Color::Ones();  ///< radiance on a white surface 1 m away, times pi
  float cone_cosine = 0.3F;         ///< of half the angle at which it has gone dark
};

struct Lighting {
  Eigen::Vector3f to_sun = Eigen::Vector3f(0.4F, 0.5F, 0.77F);  ///< unit
  Color sun = Color(1.0F, 0.95F, 0.85F) * 2.8F;  ///< irradiance of a surface that faces it, over pi
  Color zenith = Color(0.30F, 0.45F, 0.75F);     ///< radiance of the sky
  Color horizon = Color(0.75F, 0.80F, 0.85F);
  float visibility = 1500.0F;  ///< m, distance over which haze takes 1 - 1/e
  bool night = false;          ///< lit windows, head lamps, street lamps
  std::vector<Lamp> lamps;
};

/// What a driver would see. Frame "map": z up, the road at z = 0; keep within 1 km of the origin,
/// since rays are single precision.
struct World {
  std::vector<StaticObject> statics;
  std::vector<Actor> actors;
  Lighting lighting;
};

/// Attribute of an actor at a time, as nuScenes writes it: "vehicle.moving", "vehicle.stopped",
/// "vehicle.parked", "cycle.with_rider", "cycle.without_rider", "pedestrian.moving" or
/// "pedestrian.standing"; empty for categories without. Moving means faster than 0.5 m/s for
/// vehicles and 0.3 m/s for pedestrians.
std::string attributeOf(const Actor& actor, double time_s);

}  // namespace radar_dot::simulation
