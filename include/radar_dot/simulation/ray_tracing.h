// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// Where a ray ends.
struct Hit {
  float distance = 0.0F;            ///< m along the unit ray
  std::uint32_t object = kNothing;  ///< number in Snapshot::objects
  std::uint32_t triangle = 0;       ///< of its mesh
  float u = 0.0F, v = 0.0F;         ///< barycentric weights of the second and third corner
  Eigen::Vector3f normal =
      Eigen::Vector3f::UnitZ();  ///< of the triangle, unit, map frame, towards the ray's origin

  static constexpr std::uint32_t kNothing = 0xffffffffU;
  explicit operator bool() const noexcept { return object != kNothing; }
};

/// The acceleration structures of all meshes of a world, built once and shared by all snapshots.
class RayGeometry {
 public:
  explicit RayGeometry(const World& world);
  ~RayGeometry();
  RayGeometry(const RayGeometry&) = delete;
  RayGeometry& operator=(const RayGeometry&) = delete;

 private:
  friend class Snapshot;
  struct Data;
  std::unique_ptr<Data> data_;
};

/// A mesh in its place at the time of a snapshot.
struct PlacedObject {
  const Mesh* mesh = nullptr;
  const Palette* palette = nullptr;
  std::int32_t actor = -1;  ///< number in World::actors; -1 = static
  std::int32_t part = -1;   ///< of the actor's model
  Eigen::Isometry3d T_map_from_object = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< m/s, map frame, of the object's origin
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s, map frame
};

/// The world at one time, ready for rays. Tracing is const and thread-safe. World and geometry must
/// outlive it.
class Snapshot {
 public:
  Snapshot(const World& world, const RayGeometry& geometry, double time_s);
  ~Snapshot();
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  double time() const noexcept { return time_s_; }
  /// Statics first, in their order, then the parts of the actors.
  const std::vector<PlacedObject>& objects() const noexcept { return objects_; }

  /// The nearest surface along a ray. @param direction unit. Back faces count as surfaces.
  Hit trace(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m = 0.0F,
            float far_m = 1e30F) const;
  /// Is anything between near_m and far_m along the ray.
  bool blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m,
               float far_m) const;
  /// Eight rays from one origin at once, for coherent rays: as trace().
  void trace8(const Eigen::Vector3f& origin, const Eigen::Vector3f* directions, int count, Hit* hits) const;

  /// Eight questions at once, for coherent rays: as blocked(), each from its own origin to its own far_m.
  /// A far_m of 0 or less is not asked and not blocked.
  void blocked8(const Eigen::Vector3f* origins, const Eigen::Vector3f* directions, const float* far_m,
                int count, bool* blocked) const;

  /// Surface that was hit.
  const Surface& surfaceOf(const Hit& hit) const;
  /// Its colour, from the palette where it says so.
  Color colorOf(const Hit& hit) const;
  /// Interpolated shading normal, unit, map frame, on the side of hit.normal.
  Eigen::Vector3f shadingNormal(const Hit& hit) const;
  /// Velocity over ground of the surface point at `point` (map frame), m/s.
  Eigen::Vector3d velocityAt(const Hit& hit, const Eigen::Vector3d& point) const;

 private:
  double time_s_;
  std::vector<PlacedObject> objects_;
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace radar_dot::simulation
