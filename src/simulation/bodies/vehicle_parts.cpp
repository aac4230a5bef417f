// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/vehicle_parts.h"

#include <cmath>

#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;

/// Outside towards +z of the lathe, which is +y or -y of the wheel.
std::shared_ptr<const Mesh> wheelMesh(const WheelShape& shape, bool outside_left) {
  const float half = 0.5F * shape.width;
  const float r = shape.radius;
  const float rim = shape.rim_radius;
  const Eigen::Isometry3f pose =
      poseAlong(Vector3f::Zero(), outside_left ? Vector3f::UnitY() : Vector3f(-Vector3f::UnitY()));
  const Vector3f outwards = pose.linear().col(2);
  MeshBuilder builder;
  builder.use(plain(Material::kTyre, 0.025F));
  lathe(builder,
        {{-half, rim},
         {-half, r * 0.93F},
         {-half * 0.7F, r},
         {half * 0.7F, r},
         {half, r * 0.93F},
         {half * 0.9F, rim}},
        pose, 20);
  builder.use(plain(Material::kPlastic, 0.02F));
  disc(builder, pose * Vector3f(0, 0, -half * 0.95F), -outwards, rim, 12);
  disc(builder, pose * Vector3f(0, 0, half * 0.25F), outwards, rim, 14);
  builder.use({Material::kRim, Color::Constant(shape.rim_grey), -1});
  lathe(builder, {{half * 0.9F, rim * 1.01F}, {half * 0.8F, rim * 0.9F}, {half * 0.25F, rim * 0.87F}}, pose,
        20);
  lathe(builder, {{half * 0.3F, rim * 0.24F}, {half * 0.82F, rim * 0.2F}, {half * 0.85F, 0.001F}}, pose, 10);
  for (int spoke = 0; spoke < shape.spokes; ++spoke) {
    const float turn = kTwoPi * static_cast<float>(spoke) / static_cast<float>(shape.spokes);
    const Vector3f along(std::cos(turn), std::sin(turn), 0.0F);
    bar(builder, pose * (along * rim * 0.15F + Vector3f(0, 0, half * 0.66F)),
        pose * (along * rim * 0.93F + Vector3f(0, 0, half * 0.72F)), outwards,
        rim * 1.3F / static_cast<float>(shape.spokes), half * 0.25F);
  }
  return share(std::move(builder));
}

}  // namespace

void addWheel(Model& model, const WheelShape& shape, double x, double y, bool steered) {
  Part part = fixedPart(wheelMesh(shape, y > 0.0));
  part.T_parent_from_joint = translation(x, y, static_cast<double>(shape.radius));
  part.joint = steered ? JointKind::kSteeredWheel : JointKind::kWheel;
  part.radius = static_cast<double>(shape.radius);
  model.parts.push_back(std::move(part));
}

void addNumberPlate(MeshBuilder& builder, const Vector3f& centre, bool front) {
  const float ahead = front ? 1.0F : -1.0F;
  builder.use(plain(Material::kPlastic, 0.03F));
  builder.box(centre - Vector3f(0.012F, 0.27F, 0.065F), centre + Vector3f(0.012F, 0.27F, 0.065F));
  builder.use(plain(Material::kNumberPlate, 0.75F));
  const float x = centre.x() + ahead * 0.014F;
  const auto corner = [&](float across, float up) {
    return Vector3f(x, centre.y() + across * ahead * 0.26F, centre.z() + up * 0.055F);
  };
  builder.quad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
}

void addMirrors(MeshBuilder& builder, const Vector3f& root, const Vector3f& size) {
  for (const float side : {1.0F, -1.0F}) {
    const Vector3f foot(root.x(), side * root.y(), root.z());
    const Vector3f head = foot + Vector3f(-0.02F, side * (0.04F + 0.5F * size.y()), 0.5F * size.z());
    builder.use(plain(Material::kPlastic, 0.03F));
    bar(builder, foot, head, Vector3f::UnitZ(), 0.06F, 0.03F);
    builder.use(fromPalette(Material::kCarPaint, 0));
    builder.ellipsoid(head, 0.5F * size, 10, 6);
  }
}

}  // namespace radar_dot::simulation
