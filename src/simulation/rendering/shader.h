// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// Lamps that shine at this time: those of the world and the head lamps of vehicles that drive.
std::vector<Lamp> shiningLamps(const World& world, const Eigen::Isometry3d& T_map_from_base, double time_s);

/// Light from a surface.
struct SurfaceLight {
  Color radiance = Color::Zero();
  bool in_sun = false;
};

/// Is a surface point in the sun: known from before, or to be found out.
enum class Sun : std::uint8_t { kUnknown, kShines, kHidden };

/// What becomes of reflections: followed by a ray, not traced (a guess of what is there), or left out.
enum class Mirrors : std::uint8_t { kTraced, kVague, kNone };

/// Light that comes along a ray. Const and thread-safe; refers to what it was made of.
class Shader {
 public:
  Shader(const Snapshot& snapshot, const Lighting& lighting, std::vector<Lamp> lamps);

  Color sky(const Eigen::Vector3f& direction) const;

  /// Light from a surface.
  /// @param pixel_angle  rad, of one pixel
  /// @param openness     fraction of the sky above that nothing near hides, 0..1
  SurfaceLight surface(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, const Hit& hit,
                       float pixel_angle, float openness, Sun sun, Mirrors mirrors) const;
  /// Where a ray to the sun starts. false: the surface is turned away and lets no light through.
  bool canSeeSun(const Eigen::Vector3f& point, const Hit& hit, Eigen::Vector3f& start) const;
  /// Length of rays to the sun, m.
  static constexpr float kShadowReach = 400.0F;

 private:
  Color vagueReflection(const Eigen::Vector3f& direction) const;
  Color reflection(const Eigen::Vector3f& point, const Eigen::Vector3f& direction, float pixel_angle) const;
  Color lampLight(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;
  void sortLamps();

  const Snapshot& snapshot_;
  const Lighting& lighting_;
  std::vector<Lamp> lamps_;
  std::vector<Eigen::Isometry3f> T_object_from_map_;
  Color ground_glow_;

  // Lamps that reach each cell of a grid over the ground.
  float grid_x_ = 0.0F, grid_y_ = 0.0F;
  int grid_columns_ = 0, grid_rows_ = 0;
  std::vector<std::vector<int>> grid_;
};

}  // namespace radar_dot::simulation
