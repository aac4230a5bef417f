// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/mesh.h"
#include "radar_dot/simulation/model.h"

/// Helpers that the model builders share.
namespace radar_dot::simulation {

inline float uniform(RandomStream& random, float low, float high) {
  return static_cast<float>(random.uniform(static_cast<double>(low), static_cast<double>(high)));
}

inline std::shared_ptr<const Mesh> share(MeshBuilder&& builder) {
  return std::make_shared<const Mesh>(std::move(builder).build());
}

/// The mesh that `add(builder)` builds.
template <typename Add>
std::shared_ptr<const Mesh> meshOf(const Add& add) {
  MeshBuilder builder;
  add(builder);
  return share(std::move(builder));
}
/// A part that does not move in the body.
inline Part fixedPart(std::shared_ptr<const Mesh> mesh) {
  Part part;
  part.mesh = std::move(mesh);
  return part;
}

inline Surface plain(Material material, float red, float green, float blue) {
  return {material, Color(red, green, blue), -1};
}
inline Surface plain(Material material, float grey) { return plain(material, grey, grey, grey); }
inline Surface fromPalette(Material material, int slot) { return {material, Color::Constant(0.5F), slot}; }

inline Eigen::Isometry3f translation(const Eigen::Vector3f& offset) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translation() = offset;
  return pose;
}
inline Eigen::Isometry3d translation(double x, double y, double z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

/// A point of the outline that lathe() turns.
struct LathePoint {
  float height = 0.0F;
  float radius = 0.0F;
};

/// Turns an outline about the z axis of `T_mesh_from_lathe`; the outside is to the right of someone
/// who climbs the outline, i.e. listed bottom to top the solid is outside out.
void lathe(MeshBuilder& builder, const std::vector<LathePoint>& outline,
           const Eigen::Isometry3f& T_mesh_from_lathe, int sides);

/// One cross section of tube().
struct Ring {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius_x = 0.1F;
  float radius_y = 0.1F;
};

/// Smooth skin over horizontal ellipses, listed bottom to top; ends are closed.
void tube(MeshBuilder& builder, const std::vector<Ring>& rings, int sides);

/// Flat disc with its face towards `normal`.
void disc(MeshBuilder& builder, const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, float radius,
          int sides);

/// A straight bar with a rectangular section: `width` across, `height` in the plane with `up`.
void bar(MeshBuilder& builder, const Eigen::Vector3f& from, const Eigen::Vector3f& to,
         const Eigen::Vector3f& up, float width, float height);

/// Frame whose z axis is the given direction.
Eigen::Isometry3f poseAlong(const Eigen::Vector3f& origin, const Eigen::Vector3f& z_axis);

/// Box around all parts in the body frame, m.
Eigen::AlignedBox3d boundsOf(const Model& model, double distance);

/// Sets the size to the smallest box, symmetric in x and y about the origin and standing on the
/// ground, that holds all parts over a cycle of `stride` metres.
void fitSize(Model& model, double stride);

}  // namespace radar_dot::simulation
