// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/shapes.h"

#include <cmath>

#include "simulation/frames.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;

float turnOf(int side, int sides) {
  return kTwoPi * static_cast<float>(side % sides) / static_cast<float>(sides);
}

}  // namespace

Eigen::Isometry3f poseAlong(const Vector3f& origin, const Vector3f& z_axis) {
  const Vector3f z = z_axis.normalized();
  const auto [x, y] = acrossOf(z);
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = y;
  pose.linear().col(2) = z;
  pose.translation() = origin;
  return pose;
}

void lathe(MeshBuilder& builder, const std::vector<LathePoint>& outline,
           const Eigen::Isometry3f& T_mesh_from_lathe, int sides) {
  std::vector<Vector3f> points;
  for (const LathePoint& point : outline)
    for (int side = 0; side < sides; ++side)
      points.push_back(T_mesh_from_lathe * Vector3f(point.radius * std::cos(turnOf(side, sides)),
                                                    point.radius * std::sin(turnOf(side, sides)),
                                                    point.height));
  builder.sheet(points, sides);
}

void tube(MeshBuilder& builder, const std::vector<Ring>& rings, int sides) {
  std::vector<Vector3f> points;
  const auto add = [&](const Ring& ring, float scale) {
    for (int side = 0; side < sides; ++side)
      points.emplace_back(ring.centre + scale * Vector3f(ring.radius_x * std::cos(turnOf(side, sides)),
                                                         ring.radius_y * std::sin(turnOf(side, sides)),
                                                         0.0F));
  };
  add(rings.front(), 0.001F);
  for (const Ring& ring : rings) add(ring, 1.0F);
  add(rings.back(), 0.001F);
  builder.sheet(points, sides);
}

void disc(MeshBuilder& builder, const Vector3f& centre, const Vector3f& normal, float radius, int sides) {
  const Eigen::Isometry3f pose = poseAlong(centre, normal);
  const auto rim = [&](int side) {
    return Vector3f(pose * Vector3f(radius * std::cos(turnOf(side, sides)),
                                    radius * std::sin(turnOf(side, sides)), 0.0F));
  };
  for (int side = 0; side < sides; ++side) builder.triangle(centre, rim(side), rim(side + 1));
}

void bar(MeshBuilder& builder, const Vector3f& from, const Vector3f& to, const Vector3f& up, float width,
         float height) {
  const Vector3f x = (to - from).normalized();
  const Vector3f y = up.cross(x).normalized();
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = y;
  pose.linear().col(2) = x.cross(y);
  pose.translation() = 0.5F * (from + to);
  builder.box(pose, {(to - from).norm(), width, height});
}

Eigen::AlignedBox3d boundsOf(const Model& model, double distance) {
  BodyState state;
  state.distance = distance;
  const auto poses = model.T_body_from_parts(state);
  Eigen::AlignedBox3d box;
  for (std::size_t part = 0; part < poses.size(); ++part)
    for (const Vector3f& position : model.parts[part].mesh->positions)
      box.extend(poses[part] * position.cast<double>());
  return box;
}

void fitSize(Model& model, double stride) {
  constexpr int kSteps = 16;
  Eigen::AlignedBox3d box;
  for (int step = 0; step < kSteps; ++step) box.extend(boundsOf(model, stride * step / kSteps));
  const Eigen::Vector3d reach = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
  model.size = Eigen::Vector3d(2.0 * reach.x(), 2.0 * reach.y(), box.max().z());
}

}  // namespace radar_dot::simulation
