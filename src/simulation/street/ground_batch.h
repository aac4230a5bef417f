// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <memory>
#include <utility>

#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// Adds a thing without a palette.
void putStatic(World& world, std::shared_ptr<const Mesh> mesh, const Eigen::Isometry3d& T_map_from_object);

/// Collects flat pieces of ground in the frame of a street into a few meshes, each with its origin
/// nearby so that single precision keeps thin layers apart.
class GroundBatch {
 public:
  explicit GroundBatch(const Eigen::Isometry3d& T_map_from_street) : T_map_from_street_(T_map_from_street) {}

  void use(const Surface& surface) { surface_ = surface; }
  /// Horizontal, seen from above; corners in order around it.
  void quad(const std::array<Eigen::Vector2d, 4>& corners, double z);
  void rectangle(double x0, double x1, double y0, double y1, double z);
  /// A rectangle cut into tiles of about 10 m along x.
  void strip(double x0, double x1, double y0, double y1, double z);
  /// Disc of 16 sides.
  void disc(const Eigen::Vector2d& centre, double radius, double z);
  /// Upright wall below z = top.
  void wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double bottom, double top);

  void moveTo(World& world);

 private:
  struct Chunk {
    MeshBuilder builder;
    Surface surface;
    bool fresh = true;
  };
  MeshBuilder& builderAt(const Eigen::Vector2d& place, Eigen::Vector2d& origin);

  Eigen::Isometry3d T_map_from_street_;
  Surface surface_;
  std::map<std::pair<int, int>, Chunk> chunks_;
};

}  // namespace radar_dot::simulation
