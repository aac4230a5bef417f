// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "simulation/bodies/human_body.h"
#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr double kTwoPi = 6.283185307179586;
constexpr float kWheel = 0.345F;
constexpr float kFrontAxle = 0.55F;
constexpr float kRearAxle = -0.52F;
constexpr double kCrankLength = 0.17;
constexpr double kTurnsOfWheelPerCrank = 2.4;
constexpr double kCrankStride = kTurnsOfWheelPerCrank * kTwoPi * static_cast<double>(kWheel);
const Vector3f kBottomBracket(-0.08F, 0, 0.28F);
const Vector3f kSaddle(-0.27F, 0, 0.96F);  // of a bicycle without rider
constexpr float kHipsX = -0.3F;
const Vector3f kSitting(-0.03F, 0, 0.085F);  // hips above the saddle
constexpr float kAnkleOverPedal = -0.08F;    // the ball of the foot is on the pedal
constexpr double kToesDown = 0.1;            // rad
constexpr float kPedalHalf = 0.015F;
const Vector3f kBars(0.36F, 0, 1.03F);

std::shared_ptr<const Mesh> wheelMesh() {
  MeshBuilder builder;
  builder.use(plain(Material::kTyre, 0.03F));
  builder.torus(Vector3f::Zero(), Vector3f::UnitY(), kWheel - 0.019F, 0.019F, 28, 6);
  builder.use(plain(Material::kRim, 0.5F));
  builder.torus(Vector3f::Zero(), Vector3f::UnitY(), kWheel - 0.045F, 0.011F, 28, 5);
  builder.cone({0, -0.045F, 0}, {0, 0.045F, 0}, 0.022F, 0.022F, 8);
  constexpr int kSpokes = 16;
  for (int spoke = 0; spoke < kSpokes; ++spoke) {
    const float turn = static_cast<float>(kTwoPi) * static_cast<float>(spoke) / kSpokes;
    const float hub = spoke % 2 == 0 ? 0.035F : -0.035F;
    builder.cone({0, hub, 0}, (kWheel - 0.05F) * Vector3f(std::cos(turn), 0, std::sin(turn)), 0.0025F,
                 0.0025F, 4, false);
  }
  return share(std::move(builder));
}

void addFrame(MeshBuilder& builder, const Surface& paint, const Vector3f& saddle) {
  const Vector3f rear(kRearAxle, 0, kWheel);
  const Vector3f head_top(0.33F, 0, 0.87F);
  const Vector3f head_low(0.375F, 0, 0.73F);
  const Vector3f seat_top(-0.24F, 0, 0.82F);
  const auto tube = [&](const Vector3f& from, const Vector3f& to, float radius) {
    builder.cone(from, to, radius, radius, 8);
  };
  builder.use(paint);
  tube(kBottomBracket, head_low, 0.022F);
  tube(seat_top - Vector3f(0, 0, 0.06F), head_top, 0.018F);
  tube(kBottomBracket, seat_top, 0.02F);
  tube(head_low, head_top, 0.024F);
  for (const float side : {1.0F, -1.0F}) {
    const Vector3f out(0, side * 0.055F, 0);
    tube(kBottomBracket + 0.4F * out, rear + out, 0.011F);
    tube(seat_top + 0.3F * out - Vector3f(0, 0, 0.05F), rear + out, 0.009F);
    tube(head_low + 0.7F * out, Vector3f(kFrontAxle, 0, kWheel) + out, 0.013F);
    tube(head_low + 0.7F * out, head_low, 0.014F);
  }
  builder.use(plain(Material::kChrome, 0.5F));
  tube(seat_top, saddle - Vector3f(0, 0, 0.03F), 0.014F);
  tube(head_top, kBars - Vector3f(0.06F, 0, 0.02F), 0.014F);
  builder.use(plain(Material::kPlastic, 0.02F));
  for (const float side : {1.0F, -1.0F}) {
    tube(kBars - Vector3f(0.06F, 0, 0.02F), kBars + Vector3f(-0.02F, side * 0.2F, 0), 0.012F);
    tube(kBars + Vector3f(-0.02F, side * 0.2F, 0), kBars + Vector3f(-0.12F, side * 0.29F, 0), 0.014F);
  }
  builder.ellipsoid(saddle + Vector3f(-0.05F, 0, 0), {0.11F, 0.075F, 0.03F}, 12, 6);
  builder.ellipsoid(saddle + Vector3f(0.07F, 0, 0), {0.1F, 0.03F, 0.022F}, 10, 6);
}

void addMudguardsAndLamps(MeshBuilder& builder) {
  builder.use(plain(Material::kPlastic, 0.025F));
  constexpr int kPieces = 9;
  const auto guard = [&](float axle, float first, float last) {
    std::vector<Vector3f> points;
    for (int piece = 0; piece <= kPieces; ++piece) {
      const float turn =
          static_cast<float>(kTwoPi) * (first + (last - first) * static_cast<float>(piece) / kPieces);
      for (const float across : {-1.0F, 0.0F, 1.0F}) {
        const float radius = kWheel + 0.02F - 0.012F * std::abs(across);
        points.emplace_back(axle + radius * std::cos(turn), across * 0.028F,
                            kWheel + radius * std::sin(turn));
      }
    }
    builder.sheet(points, 3, false);
  };
  guard(kRearAxle, 0.08F, 0.5F);
  guard(kFrontAxle, 0.1F, 0.47F);
  builder.use(plain(Material::kHeadLamp, 0.7F));
  builder.ellipsoid({0.44F, 0, 0.84F}, {0.04F, 0.03F, 0.03F}, 10, 6);
  builder.use(plain(Material::kTailLamp, 0.4F, 0.01F, 0.01F));
  builder.ellipsoid({-0.875F, 0, 0.725F}, {0.02F, 0.04F, 0.025F}, 10, 6);
  builder.use(plain(Material::kPaintedMetal, 0.03F));  // carrier
  for (const float y : {-0.06F, 0.0F, 0.06F})
    builder.cone({-0.3F, y, 0.74F}, {-0.87F, y, 0.74F}, 0.007F, 0.007F, 5);
  for (const float y : {-0.06F, 0.06F})
    builder.cone({kRearAxle - 0.1F, y, 0.74F}, {kRearAxle, y, kWheel}, 0.007F, 0.007F, 5);
}

std::shared_ptr<const Mesh> crankMesh() {
  MeshBuilder builder;
  const auto length = static_cast<float>(kCrankLength);
  builder.use(plain(Material::kChrome, 0.4F));
  builder.torus({0, -0.045F, 0}, Vector3f::UnitY(), 0.085F, 0.008F, 16, 4);
  builder.cone({0, -0.07F, 0}, {0, 0.07F, 0}, 0.018F, 0.018F, 8);
  bar(builder, {0, 0.075F, 0}, {0, 0.085F, -length}, Vector3f::UnitY(), 0.025F, 0.015F);
  bar(builder, {0, -0.075F, 0}, {0, -0.085F, length}, Vector3f::UnitY(), 0.025F, 0.015F);
  builder.use(plain(Material::kPlastic, 0.02F));
  builder.box({-0.045F, 0.09F, -length - 0.012F}, {0.045F, 0.18F, -length + 0.012F});
  builder.box({-0.045F, -0.18F, length - 0.012F}, {0.045F, -0.09F, length + 0.012F});
  return share(std::move(builder));
}

/// Frames are not of the palette, whose slots the rider needs.
Surface framePaint(RandomStream& random) {
  constexpr float kPaints[][3] = {{0.02F, 0.02F, 0.02F}, {0.4F, 0.03F, 0.03F},  {0.55F, 0.55F, 0.55F},
                                  {0.03F, 0.1F, 0.28F},  {0.04F, 0.18F, 0.09F}, {0.1F, 0.1F, 0.1F}};
  const auto& paint = kPaints[random.index(static_cast<int>(std::size(kPaints)))];
  return plain(Material::kPaintedMetal, paint[0], paint[1], paint[2]);
}

/// A bicycle whose wheels touch the ground; the left pedal is down at distance 0.
Model bicycle(RandomStream& random, const Vector3f& saddle) {
  Model model;
  model.category = "vehicle.bicycle";
  model.rear_axle_x = static_cast<double>(kRearAxle);
  MeshBuilder frame;
  addFrame(frame, framePaint(random), saddle);
  addMudguardsAndLamps(frame);
  model.parts.push_back(fixedPart(share(std::move(frame))));
  const auto wheel = wheelMesh();
  for (const float axle : {kFrontAxle, kRearAxle}) {
    Part part = fixedPart(wheel);
    part.T_parent_from_joint = translation(static_cast<double>(axle), 0.0, static_cast<double>(kWheel));
    part.joint = JointKind::kWheel;
    part.radius = static_cast<double>(kWheel);
    model.parts.push_back(std::move(part));
  }
  Part crank = fixedPart(crankMesh());
  crank.T_parent_from_joint.translation() = kBottomBracket.cast<double>();
  crank.joint = JointKind::kCrank;
  crank.stride = kCrankStride;
  model.parts.push_back(std::move(crank));
  return model;
}

/// Angles of hip and knee that put the ankle somewhere, rad about y; limbs hang down at 0.
struct LegAngles {
  double hip, knee;
};
LegAngles reach(const Eigen::Vector2d& hip_to_ankle, double thigh, double shank) {
  const double distance = std::min(hip_to_ankle.norm(), 0.999 * (thigh + shank));
  const double knee =
      std::acos((thigh * thigh + shank * shank - distance * distance) / (2.0 * thigh * shank));
  const double lift =
      std::acos((thigh * thigh + distance * distance - shank * shank) / (2.0 * thigh * distance));
  const double direction = std::atan2(-hip_to_ankle.x(), -hip_to_ankle.y());
  return {direction - lift, kTwoPi / 2.0 - knee};
}

/// The best swing (offset + amplitude sin(cycle + phase)) through the samples of one cycle.
void fitSwing(Part& part, const std::array<double, 32>& samples) {
  double mean = 0.0, sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double cycle = kTwoPi * static_cast<double>(i) / static_cast<double>(samples.size());
    mean += samples[i] / static_cast<double>(samples.size());
    sine += 2.0 * samples[i] * std::sin(cycle) / static_cast<double>(samples.size());
    cosine += 2.0 * samples[i] * std::cos(cycle) / static_cast<double>(samples.size());
  }
  part.joint = JointKind::kSwing;
  part.stride = kCrankStride;
  part.offset = mean;
  part.amplitude = std::hypot(sine, cosine);
  part.phase = std::atan2(cosine, sine);
}

void addLegs(Model& model, const Physique& body, const Eigen::Vector3d& hips) {
  const auto thigh = meshOf([&](MeshBuilder& builder) { addThigh(builder, body, false); });
  const auto shank = meshOf([&](MeshBuilder& builder) { addShank(builder, body, false); });
  const auto foot = meshOf([&](MeshBuilder& builder) { addFoot(builder, body); });
  const auto thigh_length = static_cast<double>(body.thigh);
  const auto shank_length = static_cast<double>(body.shank);
  for (const double side : {1.0, -1.0}) {
    std::array<double, 32> hip{}, knee{}, sole{};
    for (std::size_t i = 0; i < hip.size(); ++i) {
      const double cycle = kTwoPi * static_cast<double>(i) / static_cast<double>(hip.size());
      // The left pedal points down at cycle 0; a positive turn about y moves it backwards.
      const Eigen::Vector2d pedal(
          static_cast<double>(kBottomBracket.x()) - side * kCrankLength * std::sin(cycle),
          static_cast<double>(kBottomBracket.z()) - side * kCrankLength * std::cos(cycle));
      const Eigen::Vector2d ankle =
          pedal + Eigen::Vector2d(static_cast<double>(kAnkleOverPedal),
                                  static_cast<double>(body.ankle_height + kPedalHalf));
      const LegAngles angles = reach(ankle - Eigen::Vector2d(hips.x(), hips.z()), thigh_length, shank_length);
      hip[i] = angles.hip;
      knee[i] = angles.knee;
      sole[i] = kToesDown - angles.hip - angles.knee;
    }
    Part upper = fixedPart(thigh);
    upper.T_parent_from_joint = translation(hips.x(), side * static_cast<double>(body.hip_half), hips.z());
    fitSwing(upper, hip);
    model.parts.push_back(std::move(upper));
    Part lower = fixedPart(shank);
    lower.parent = static_cast<int>(model.parts.size()) - 1;
    lower.T_parent_from_joint = translation(0, 0.02 * side, -thigh_length);
    fitSwing(lower, knee);
    model.parts.push_back(std::move(lower));
    Part shoe = fixedPart(foot);
    shoe.parent = static_cast<int>(model.parts.size()) - 1;
    shoe.T_parent_from_joint = translation(0, 0, -shank_length);
    fitSwing(shoe, sole);
    model.parts.push_back(std::move(shoe));
  }
}

/// Where the hips are so that the lower pedal takes an almost straight leg.
Vector3f hipsAbovePedals(const Physique& body) {
  const float leg = 0.97F * (body.thigh + body.shank);
  const float ahead = kBottomBracket.x() + kAnkleOverPedal - kHipsX;
  const float ankle_z =
      kBottomBracket.z() - static_cast<float>(kCrankLength) + body.ankle_height + kPedalHalf;
  return {kHipsX, 0.0F, ankle_z + std::sqrt(leg * leg - ahead * ahead)};
}

/// Trunk, head and arms never move against the bicycle: one mesh.
std::shared_ptr<const Mesh> upperBody(const Physique& body, const Vector3f& hips, float lean, HeadWear wear) {
  MeshBuilder builder;
  MeshBuilder torso, head, upper_arm, forearm;
  addTorso(torso, body, Garment::kJacket);
  addHead(head, body, wear);
  addUpperArm(upper_arm, body);
  addForearm(forearm, body);
  Eigen::Isometry3f T_body_from_torso = translation(hips);
  T_body_from_torso.rotate(Eigen::AngleAxisf(lean, Vector3f::UnitY()));
  builder.add(torso.mesh(), T_body_from_torso);
  Eigen::Isometry3f T_body_from_head = T_body_from_torso * translation(Vector3f(0, 0, body.torso));
  T_body_from_head.rotate(Eigen::AngleAxisf(-0.75F * lean, Vector3f::UnitY()));
  builder.add(head.mesh(), T_body_from_head);
  for (const float side : {1.0F, -1.0F}) {
    const Vector3f shoulder = T_body_from_torso * Vector3f(0, side * body.shoulder_half, body.torso - 0.03F);
    const Vector3f hand = kBars + Vector3f(-0.1F, side * 0.27F, 0.02F);
    // The elbow lies below the straight line from shoulder to hand.
    const float reach_length = (hand - shoulder).norm();
    const float arm = body.upper_arm;
    const float rest = body.forearm + 0.06F;
    const float along = std::clamp(
        (reach_length * reach_length + arm * arm - rest * rest) / (2.0F * reach_length), -arm, arm);
    const Vector3f line = (hand - shoulder) / reach_length;
    Vector3f down = Vector3f(0, side * 0.35F, -1.0F);
    down = (down - down.dot(line) * line).normalized();
    const Vector3f elbow =
        shoulder + along * line + std::sqrt(std::max(0.0F, arm * arm - along * along)) * down;
    builder.add(upper_arm.mesh(), poseAlong(shoulder, shoulder - elbow));
    builder.add(forearm.mesh(), poseAlong(elbow, elbow - hand));
  }
  return share(std::move(builder));
}

std::shared_ptr<const Model> finish(Model&& model) {
  fitSize(model, kCrankStride);
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace

std::shared_ptr<const Model> makeCyclist(RandomStream& random) {
  const Physique body = physiqueOf(uniform(random, 1.62F, 1.85F), uniform(random, 0.95F, 1.1F));
  const Vector3f hips = hipsAbovePedals(body);
  Model model = bicycle(random, hips - kSitting);
  const double wear = random.uniform();
  model.parts.push_back(fixedPart(upperBody(body, hips, uniform(random, 0.35F, 0.55F),
                                            wear < 0.5   ? HeadWear::kHelmet
                                            : wear < 0.8 ? HeadWear::kShortHair
                                                         : HeadWear::kLongHair)));
  addLegs(model, body, hips.cast<double>());
  return finish(std::move(model));
}

std::shared_ptr<const Model> makeParkedBicycle(RandomStream& random) {
  Model model = bicycle(random, kSaddle);
  model.parts.back().phase = random.uniform(0.0, kTwoPi);
  return finish(std::move(model));
}

}  // namespace radar_dot::simulation
