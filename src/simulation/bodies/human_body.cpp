// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/human_body.h"

#include <vector>

#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr int kSides = 14;
constexpr int kLimbSides = 8;

Surface cloth(int slot) { return fromPalette(Material::kCloth, slot); }
Surface skin() { return fromPalette(Material::kSkin, 2); }

Ring ring(float x, float z, float depth, float width) { return {Vector3f(x, 0, z), depth, width}; }

}  // namespace

Physique physiqueOf(float height, float girth) {
  const float scale = height / 1.75F;
  Physique body;
  body.height = height;
  body.girth = girth;
  for (float* length : {&body.thigh, &body.shank, &body.ankle_height, &body.upper_arm, &body.forearm,
                        &body.torso, &body.hip_half, &body.shoulder_half})
    *length *= scale;
  return body;
}

void addTorso(MeshBuilder& builder, const Physique& body, Garment garment) {
  const float g = body.girth;
  const float t = body.torso;
  const float hip = body.hip_half;
  const float shoulder = body.shoulder_half;
  std::vector<Ring> rings;
  if (garment == Garment::kJacket) {
    builder.use(cloth(1));
    tube(builder,
         {ring(0, -0.1F, 0.07F * g, 0.1F * g), ring(0, -0.04F, 0.11F * g, hip + 0.075F * g),
          ring(0, 0.06F, 0.115F * g, hip + 0.08F * g), ring(0, 0.12F, 0.1F * g, hip + 0.06F * g)},
         kSides);
    rings = {ring(0, -0.03F, 0.125F * g, hip + 0.088F * g), ring(0, 0.06F, 0.128F * g, hip + 0.09F * g)};
  } else {
    const float flare = garment == Garment::kDress ? 0.06F : 0.025F;
    const float hem = -0.95F * body.thigh;
    rings = {ring(0, hem, 0.15F * g + flare, hip + 0.085F * g + flare),
             ring(0, 0.5F * hem, 0.14F * g + 0.5F * flare, hip + 0.09F * g + 0.4F * flare),
             ring(0, 0.0F, 0.128F * g, hip + 0.09F * g)};
  }
  const std::vector<Ring> upper = {ring(0, 0.38F * t, 0.11F * g, 0.145F * g),
                                   ring(0.01F, 0.6F * t, 0.12F * g, 0.16F * g),
                                   ring(0.005F, 0.8F * t, 0.118F * g, 0.9F * shoulder),
                                   ring(0.0F, 0.92F * t, 0.098F * g, 1.04F * shoulder),
                                   ring(-0.005F, 1.0F * t, 0.08F * g, 0.92F * shoulder),
                                   ring(-0.01F, 1.065F * t, 0.065F, 0.5F * shoulder),
                                   ring(-0.005F, 1.12F * t, 0.052F, 0.058F)};
  rings.insert(rings.end(), upper.begin(), upper.end());
  builder.use(cloth(0));
  tube(builder, rings, kSides);
}

void addHead(MeshBuilder& builder, const Physique& body, HeadWear wear) {
  const float top = body.height - body.shoulderHeight();  // of the head above the shoulders
  const float chin = top - 0.225F;                        // small and tall people have heads of one size
  const Vector3f middle(0.02F, 0, chin + 0.11F);
  builder.use(skin());
  builder.cone({-0.005F, 0, 0.0F}, {0.012F, 0, chin + 0.05F}, 0.056F, 0.05F, 10, false);
  tube(builder,
       {ring(0.055F, chin, 0.03F, 0.03F), ring(0.04F, chin + 0.025F, 0.062F, 0.05F),
        ring(0.025F, chin + 0.07F, 0.084F, 0.066F), ring(0.018F, chin + 0.12F, 0.093F, 0.074F),
        ring(0.015F, chin + 0.165F, 0.092F, 0.073F), ring(0.012F, chin + 0.2F, 0.07F, 0.056F),
        ring(0.012F, chin + 0.22F, 0.03F, 0.025F)},
       12);
  builder.ellipsoid({0.112F, 0, chin + 0.09F}, {0.018F, 0.013F, 0.022F}, 8, 4);
  for (const float side : {1.0F, -1.0F})
    builder.ellipsoid({0.01F, side * 0.074F, chin + 0.1F}, {0.016F, 0.01F, 0.028F}, 6, 4);
  builder.use(plain(Material::kHair, 0.03F, 0.02F, 0.015F));
  for (const float side : {1.0F, -1.0F})
    builder.ellipsoid({0.098F, side * 0.031F, chin + 0.118F}, {0.008F, 0.015F, 0.007F}, 6, 4);
  const Vector3f crown = middle + Vector3f(-0.018F, 0, 0.03F);
  if (wear == HeadWear::kHelmet) {
    builder.use(plain(Material::kPlastic, 0.6F, 0.6F, 0.6F));
    builder.ellipsoid(crown + Vector3f(0.012F, 0, 0.03F), {0.135F, 0.105F, 0.085F}, 14, 8);
    return;
  }
  builder.use(wear == HeadWear::kCap ? fromPalette(Material::kCloth, 3) : fromPalette(Material::kHair, 3));
  builder.ellipsoid(crown, {0.105F, 0.088F, 0.092F}, 14, 8);
  builder.ellipsoid(middle + Vector3f(-0.05F, 0, -0.015F), {0.062F, 0.077F, 0.085F}, 12, 6);
  if (wear == HeadWear::kCap)
    builder.ellipsoid(crown + Vector3f(0.11F, 0, 0.0F), {0.06F, 0.07F, 0.012F}, 10, 4);
  if (wear == HeadWear::kLongHair)
    tube(builder,
         {ring(-0.055F, chin - 0.09F, 0.04F, 0.085F), ring(-0.05F, chin, 0.055F, 0.095F),
          ring(-0.04F, chin + 0.1F, 0.07F, 0.09F), ring(-0.03F, chin + 0.18F, 0.07F, 0.075F)},
         12);
}

void addThigh(MeshBuilder& builder, const Physique& body, bool bare) {
  builder.use(bare ? skin() : cloth(1));
  builder.capsule({0, 0, -0.02F}, {0, 0, -body.thigh}, 0.084F * body.girth, 0.058F * body.girth, kLimbSides);
}

void addShank(MeshBuilder& builder, const Physique& body, bool bare) {
  const float ankle = -body.shank;
  builder.use(bare ? skin() : cloth(1));
  const float wide = bare ? 0.75F : 1.0F;
  tube(builder,
       {ring(-0.005F, ankle - 0.02F, 0.05F * wide, 0.045F * wide),
        ring(-0.012F, 0.5F * ankle, 0.058F * body.girth, 0.054F * body.girth),
        ring(-0.008F, 0.3F * ankle, 0.062F * body.girth, 0.056F * body.girth),
        ring(0, 0.0F, 0.058F * body.girth, 0.056F * body.girth), ring(0, 0.03F, 0.04F, 0.04F)},
       kLimbSides);
}

void addFoot(MeshBuilder& builder, const Physique& body) {
  const float sole = -body.ankle_height;
  builder.use(plain(Material::kLeather, 0.035F, 0.03F, 0.028F));
  std::vector<Ring> shoe = {ring(0.055F, sole, 0.135F, 0.045F), ring(0.055F, sole + 0.025F, 0.14F, 0.048F),
                            ring(0.035F, sole + 0.055F, 0.105F, 0.045F),
                            ring(-0.01F, sole + 0.085F, 0.058F, 0.042F),
                            ring(-0.012F, sole + 0.11F, 0.05F, 0.042F)};
  tube(builder, shoe, 12);
}

void addUpperArm(MeshBuilder& builder, const Physique& body) {
  builder.use(cloth(0));
  builder.capsule({0, 0, -0.01F}, {0, 0, -body.upper_arm}, 0.055F * body.girth, 0.046F * body.girth,
                  kLimbSides);
}

void addForearm(MeshBuilder& builder, const Physique& body) {
  builder.use(cloth(0));
  builder.capsule({0, 0, 0}, {0, 0, -body.forearm + 0.02F}, 0.045F * body.girth, 0.035F * body.girth,
                  kLimbSides);
  builder.use(skin());
  builder.ellipsoid({0.01F, 0, -body.forearm - 0.07F}, {0.036F, 0.02F, 0.085F}, 8, 6);
}

}  // namespace radar_dot::simulation
