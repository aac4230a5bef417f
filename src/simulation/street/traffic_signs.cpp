// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <iterator>
#include <vector>

#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;
constexpr float kFaceX = -0.06F;      // m, in front of the pole
constexpr float kLayer = 0.004F;      // m, of one paint over the other
constexpr float kThickness = 0.012F;  // m

using Polygon = std::vector<Vector2f>;  // (right, up) as its reader sees it, counter-clockwise

Polygon regular(int corners, float radius, float first_turn) {
  Polygon polygon;
  for (int corner = 0; corner < corners; ++corner) {
    const float turn = kTwoPi * (first_turn + static_cast<float>(corner) / static_cast<float>(corners));
    polygon.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
  }
  return polygon;
}

Polygon rectangle(float left, float bottom, float right, float top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

/// Draws on a plate that looks to -x; its reader's right is -y.
class SignFace {
 public:
  SignFace(MeshBuilder& builder, float height) : builder_(builder), height_(height) {}

  /// The plate itself: face, grey back and edge.
  void plate(const Polygon& polygon, const Color& color) {
    paint(polygon, color);
    builder_.use(plain(Material::kPaintedMetal, 0.35F));
    const float back = kFaceX + kThickness;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2f& a = polygon[i];
      const Vector2f& b = polygon[(i + 1) % polygon.size()];
      builder_.triangle(at(Vector2f::Zero(), back), at(b, back), at(a, back));
      builder_.quad(at(b, kFaceX), at(a, kFaceX), at(a, back), at(b, back));
    }
  }
  /// A convex symbol, above everything painted before.
  void paint(const Polygon& polygon, const Color& color) {
    builder_.use({Material::kSign, color, -1});
    const float x = kFaceX - kLayer * static_cast<float>(layer_++);
    Vector2f middle = Vector2f::Zero();
    for (const Vector2f& point : polygon) middle += point / static_cast<float>(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i)
      builder_.triangle(at(middle, x), at(polygon[i], x), at(polygon[(i + 1) % polygon.size()], x));
  }

 private:
  Vector3f at(const Vector2f& point, float x) const { return {x, -point.x(), height_ + point.y()}; }

  MeshBuilder& builder_;
  float height_;
  int layer_ = 0;
};

const Color kRed(0.5F, 0.03F, 0.03F);
const Color kWhite(0.8F, 0.8F, 0.8F);
const Color kBlue(0.03F, 0.12F, 0.42F);
const Color kBlack(0.02F, 0.02F, 0.02F);
const Color kYellow(0.75F, 0.5F, 0.03F);

void speedLimit(SignFace& face) {
  face.plate(regular(28, 0.3F, 0.0F), kRed);
  face.paint(regular(28, 0.235F, 0.0F), kWhite);
  // "30" out of strokes: a three and a nought.
  for (const float z : {-0.12F, -0.015F, 0.09F}) face.paint(rectangle(-0.14F, z, -0.03F, z + 0.03F), kBlack);
  face.paint(rectangle(-0.05F, -0.12F, -0.02F, 0.12F), kBlack);
  for (const float x : {0.03F, 0.11F}) face.paint(rectangle(x, -0.12F, x + 0.03F, 0.12F), kBlack);
  for (const float z : {-0.12F, 0.09F}) face.paint(rectangle(0.03F, z, 0.14F, z + 0.03F), kBlack);
}

void noEntry(SignFace& face) {
  face.plate(regular(28, 0.3F, 0.0F), kWhite);
  face.paint(regular(28, 0.285F, 0.0F), kRed);
  face.paint(rectangle(-0.2F, -0.05F, 0.2F, 0.05F), kWhite);
}

void turnAhead(SignFace& face) {
  face.plate(regular(28, 0.3F, 0.0F), kWhite);
  face.paint(regular(28, 0.285F, 0.0F), kBlue);
  face.paint(rectangle(-0.03F, -0.18F, 0.03F, 0.08F), kWhite);
  face.paint({{-0.11F, 0.06F}, {0.11F, 0.06F}, {0.0F, 0.2F}}, kWhite);
}

void warning(SignFace& face) {
  face.plate(regular(3, 0.47F, 0.25F), kRed);
  face.paint(regular(3, 0.34F, 0.25F), kWhite);
  face.paint({{-0.025F, -0.03F}, {0.025F, -0.03F}, {0.035F, 0.16F}, {-0.035F, 0.16F}}, kBlack);
  face.paint(regular(12, 0.032F, 0.0F), kBlack);
}

void giveWay(SignFace& face) {
  face.plate(regular(3, 0.47F, 0.75F), kRed);
  face.paint(regular(3, 0.3F, 0.75F), kWhite);
}

void priorityRoad(SignFace& face) {
  face.plate(regular(4, 0.42F, 0.0F), kWhite);
  face.paint(regular(4, 0.4F, 0.0F), kBlack);
  face.paint(regular(4, 0.38F, 0.0F), kWhite);
  face.paint(regular(4, 0.27F, 0.0F), kYellow);
}

void parking(SignFace& face) {
  face.plate(rectangle(-0.3F, -0.3F, 0.3F, 0.3F), kWhite);
  face.paint(rectangle(-0.285F, -0.285F, 0.285F, 0.285F), kBlue);
  face.paint(rectangle(-0.12F, -0.2F, -0.05F, 0.2F), kWhite);
  face.paint(rectangle(-0.05F, 0.13F, 0.1F, 0.2F), kWhite);
  face.paint(rectangle(-0.05F, -0.03F, 0.1F, 0.04F), kWhite);
  face.paint(rectangle(0.07F, -0.01F, 0.14F, 0.18F), kWhite);
}

void crossing(SignFace& face) {
  face.plate(rectangle(-0.3F, -0.3F, 0.3F, 0.3F), kWhite);
  face.paint(rectangle(-0.285F, -0.285F, 0.285F, 0.285F), kBlue);
  face.paint(regular(3, 0.29F, 0.25F), kWhite);
  face.paint(regular(12, 0.035F, 0.0F), kBlack);
  face.paint({{-0.03F, -0.04F}, {0.03F, -0.04F}, {0.02F, 0.06F}, {-0.02F, 0.06F}}, kBlack);
  face.paint({{-0.1F, -0.13F}, {-0.06F, -0.13F}, {0.02F, -0.03F}, {-0.02F, -0.03F}}, kBlack);
  face.paint({{0.06F, -0.13F}, {0.1F, -0.13F}, {0.02F, -0.03F}, {-0.02F, -0.03F}}, kBlack);
}

}  // namespace

std::shared_ptr<const Mesh> makeTrafficSign(RandomStream& random) {
  using Painter = void (*)(SignFace&);
  constexpr Painter kPainters[] = {speedLimit, noEntry,      turnAhead, warning,
                                   giveWay,    priorityRoad, parking,   crossing};
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.38F));
  lathe(builder, {{0.0F, 0.032F}, {2.72F, 0.032F}, {2.73F, 0.001F}}, Eigen::Isometry3f::Identity(), 10);
  for (const float z : {2.2F, 2.55F})
    builder.box({kFaceX + kThickness, -0.05F, z}, {0.035F, 0.05F, z + 0.03F});
  SignFace face(builder, 2.38F);
  kPainters[random.index(static_cast<int>(std::size(kPainters)))](face);
  return share(std::move(builder));
}

}  // namespace radar_dot::simulation
