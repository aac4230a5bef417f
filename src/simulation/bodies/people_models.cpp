// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulation/bodies/human_body.h"
#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr double kHalfTurn = 3.14159265358979;
constexpr double kHipSwing = 0.39;   // rad
constexpr double kKneeBend = 0.55;   // rad
constexpr double kAnkleShare = 0.6;  // of the hip's turn
constexpr double kBobArm = 3.0;      // m, see bobJoint()
constexpr double kSwingsPerStride = 2.0;

/// The hips sink twice a stride, when the legs are apart. Joints only turn, so the body hangs on an arm
/// so long that the turn is next to nothing.
Part bobJoint(double stride) {
  Part part;
  part.T_parent_from_joint = translation(-kBobArm, 0.0, 0.0);
  part.joint = JointKind::kSwing;
  part.stride = stride / kSwingsPerStride;
  part.phase = 0.5 * kHalfTurn;
  return part;
}

Part swinging(std::shared_ptr<const Mesh> mesh, int parent, const Eigen::Isometry3d& place, double stride,
              double amplitude, double phase) {
  Part part = fixedPart(std::move(mesh));
  part.parent = parent;
  part.T_parent_from_joint = place;
  part.joint = JointKind::kSwing;
  part.stride = stride;
  part.amplitude = amplitude;
  part.phase = phase;
  return part;
}

void addBag(MeshBuilder& builder, const Physique& body) {
  builder.use(plain(Material::kLeather, 0.06F, 0.045F, 0.04F));
  const float z = body.hipHeight() + 0.02F;
  const auto arm = static_cast<float>(kBobArm);
  builder.box({arm - 0.15F, body.hip_half + 0.1F, z - 0.16F}, {arm + 0.15F, body.hip_half + 0.18F, z + 0.1F});
  bar(builder, {arm + 0.1F, body.hip_half + 0.13F, z + 0.09F},
      {arm, 0.55F * body.shoulder_half, body.shoulderHeight() + 0.045F}, Vector3f::UnitX(), 0.03F, 0.02F);
}

void addBackpack(MeshBuilder& builder, const Physique& body) {
  builder.use(plain(Material::kCloth, 0.05F, 0.06F, 0.08F));
  const float z = body.shoulderHeight() - 0.24F;
  builder.ellipsoid({static_cast<float>(kBobArm) - 0.17F, 0, z}, {0.11F, 0.16F, 0.24F}, 12, 8);
}

/// A swing of limbs: left and right, arms and legs in antiphase.
struct Gait {
  double stride;     ///< m
  double amplitude;  ///< rad
};

int last(const Model& model) { return static_cast<int>(model.parts.size()) - 1; }

void addLegs(Model& model, const Physique& body, const Gait& gait, bool bare) {
  const auto thigh = meshOf([&](MeshBuilder& builder) { addThigh(builder, body, bare); });
  const auto shank = meshOf([&](MeshBuilder& builder) { addShank(builder, body, bare); });
  const auto foot = meshOf([&](MeshBuilder& builder) { addFoot(builder, body); });
  for (const double side : {1.0, -1.0}) {
    const double phase = side > 0.0 ? 0.0 : kHalfTurn;
    const Eigen::Isometry3d hip = translation(kBobArm, side * static_cast<double>(body.hip_half),
                                              static_cast<double>(body.hipHeight()));
    model.parts.push_back(swinging(thigh, 0, hip, gait.stride, gait.amplitude, phase));
    // Bends while the leg hangs behind and swings forward; straight when it stands.
    Part knee = swinging(shank, last(model), translation(0, 0, -static_cast<double>(body.thigh)), gait.stride,
                         kKneeBend, phase);
    knee.joint = JointKind::kBend;
    model.parts.push_back(std::move(knee));
    // Keeps the sole near the ground while the leg turns over it.
    model.parts.push_back(swinging(foot, last(model), translation(0, 0, -static_cast<double>(body.shank)),
                                   gait.stride, -kAnkleShare * gait.amplitude, phase));
  }
}

void addArms(Model& model, const Physique& body, const Gait& gait) {
  const auto upper_arm = meshOf([&](MeshBuilder& builder) { addUpperArm(builder, body); });
  const auto forearm = meshOf([&](MeshBuilder& builder) { addForearm(builder, body); });
  for (const double side : {1.0, -1.0}) {
    const double phase = side > 0.0 ? kHalfTurn : 0.0;
    Eigen::Isometry3d shoulder = translation(kBobArm, side * static_cast<double>(body.shoulder_half),
                                             static_cast<double>(body.shoulderHeight()) - 0.05);
    shoulder.rotate(Eigen::AngleAxisd(side * 0.1, Eigen::Vector3d::UnitX()));
    model.parts.push_back(swinging(upper_arm, 0, shoulder, gait.stride, gait.amplitude, phase));
    Part elbow = swinging(forearm, last(model), translation(0, 0, -static_cast<double>(body.upper_arm)),
                          gait.stride, 0.15, phase);
    elbow.offset = -0.28;
    model.parts.push_back(std::move(elbow));
  }
}

double lowestZ(const Model& model, double distance) { return boundsOf(model, distance).min().z(); }

}  // namespace

std::shared_ptr<const Model> makePedestrian(RandomStream& random) {
  const Physique body = physiqueOf(uniform(random, 1.55F, 1.9F), uniform(random, 0.95F, 1.18F));
  const double clothes = random.uniform();
  const Garment garment = clothes < 0.55   ? Garment::kJacket
                          : clothes < 0.82 ? Garment::kCoat
                                           : Garment::kDress;
  const double on_head = random.uniform();
  const HeadWear wear = garment == Garment::kDress || on_head < 0.35 ? HeadWear::kLongHair
                        : on_head < 0.88                             ? HeadWear::kShortHair
                                                                     : HeadWear::kCap;
  const double luggage = random.uniform();
  const auto hip_height = static_cast<double>(body.hipHeight());
  const double stride = 4.0 * hip_height * std::sin(kHipSwing) * 0.95;

  Model model;
  model.category = "human.pedestrian.adult";
  Part trunk = bobJoint(stride);
  trunk.mesh = meshOf([&](MeshBuilder& builder) {
    MeshBuilder torso;
    addTorso(torso, body, garment);
    MeshBuilder head;
    addHead(head, body, wear);
    const auto arm = static_cast<float>(kBobArm);
    builder.add(torso.mesh(), translation(Vector3f(arm, 0, body.hipHeight())));
    builder.add(head.mesh(), translation(Vector3f(arm, 0, body.shoulderHeight())));
    if (luggage < 0.25) addBag(builder, body);
    if (luggage > 0.75) addBackpack(builder, body);
  });
  model.parts.push_back(std::move(trunk));

  const double hip_swing = garment == Garment::kJacket ? kHipSwing : 0.85 * kHipSwing;
  addLegs(model, body, {stride, hip_swing}, garment == Garment::kDress);
  addArms(model, body, {stride, random.uniform(0.3, 0.45)});
  const double raised = std::max(0.0, lowestZ(model, 0.25 * stride));
  model.parts.front().amplitude = -0.5 * raised / kBobArm;
  model.parts.front().offset = 0.5 * raised / kBobArm;
  fitSize(model, stride);
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace radar_dot::simulation
