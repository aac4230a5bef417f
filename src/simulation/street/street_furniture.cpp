// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;
const Eigen::Isometry3f kUpright = Eigen::Isometry3f::Identity();

}  // namespace

std::shared_ptr<const Mesh> makeStreetLamp(double height, double reach) {
  const auto top = static_cast<float>(height);
  const auto arm = static_cast<float>(reach);
  constexpr float kRise = 0.35F;  // of the arm from the pole to the lamp
  constexpr int kPieces = 6;
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.22F, 0.24F, 0.24F));
  lathe(builder,
        {{0.0F, 0.11F}, {0.9F, 0.105F}, {1.0F, 0.075F}, {top - kRise, 0.045F}, {top - kRise + 0.02F, 0.001F}},
        kUpright, 12);
  builder.use(plain(Material::kPaintedMetal, 0.16F));
  builder.box({-0.12F, -0.05F, 0.35F}, {-0.1F, 0.05F, 0.8F});
  builder.use(plain(Material::kPaintedMetal, 0.22F, 0.24F, 0.24F));
  const auto along = [&](int piece) {
    const float angle = 0.25F * kTwoPi * static_cast<float>(piece) / kPieces;
    return Vector3f(arm * (1.0F - std::cos(angle)) * 0.85F, 0.0F,
                    top - kRise + (kRise + 0.06F) * std::sin(angle));
  };
  for (int piece = 0; piece < kPieces; ++piece)
    builder.cone(along(piece), along(piece + 1), 0.04F, 0.035F, 10, false);
  builder.cone(along(kPieces), {arm - 0.1F, 0, top + 0.06F}, 0.035F, 0.03F, 10, false);
  builder.use(plain(Material::kPaintedMetal, 0.3F));
  builder.ellipsoid({arm, 0, top + 0.07F}, {0.38F, 0.15F, 0.07F}, 16, 8);
  builder.use(plain(Material::kStreetLamp, 0.85F, 0.82F, 0.75F));
  lathe(builder, {{top - 0.03F, 0.001F}, {top - 0.02F, 0.08F}, {top + 0.03F, 0.11F}},
        translation(Vector3f(arm, 0, 0)), 12);
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeTrafficLight() {
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.12F, 0.13F, 0.13F));
  lathe(builder, {{0.0F, 0.09F}, {0.05F, 0.09F}, {0.06F, 0.055F}, {3.35F, 0.055F}, {3.37F, 0.001F}}, kUpright,
        12);
  builder.use(plain(Material::kPlastic, 0.015F));
  builder.box({-0.27F, -0.17F, 2.3F}, {-0.09F, 0.17F, 3.3F});
  for (const float z : {2.5F, 3.1F}) builder.box({-0.1F, -0.03F, z - 0.03F}, {0.0F, 0.03F, z + 0.03F});
  builder.use(plain(Material::kPlastic, 0.8F));  // contrast border of the backing board
  builder.box({-0.14F, -0.27F, 2.2F}, {-0.125F, 0.27F, 3.4F});
  builder.use(plain(Material::kPlastic, 0.015F));
  builder.box({-0.15F, -0.24F, 2.23F}, {-0.12F, 0.24F, 3.37F});
  const Color faces[] = {Color(0.6F, 0.03F, 0.02F), Color(0.25F, 0.15F, 0.01F), Color(0.01F, 0.16F, 0.09F)};
  for (int lamp = 0; lamp < 3; ++lamp) {
    const float z = 3.12F - 0.32F * static_cast<float>(lamp);
    builder.use({Material::kPlastic, faces[lamp], -1});
    builder.ellipsoid({-0.265F, 0, z}, {0.03F, 0.105F, 0.105F}, 16, 8);
    builder.use(plain(Material::kPlastic, 0.015F));
    constexpr int kVisorPieces = 8;
    const auto rim = [&](int piece, float x) {
      const float angle = kTwoPi * (0.02F + 0.46F * static_cast<float>(piece) / kVisorPieces);
      return Vector3f(x, 0.125F * std::cos(angle), z + 0.125F * std::sin(angle));
    };
    for (int piece = 0; piece < kVisorPieces; ++piece)
      builder.quad(rim(piece, -0.27F), rim(piece, -0.45F), rim(piece + 1, -0.45F), rim(piece + 1, -0.27F));
  }
  builder.use(plain(Material::kPaintedMetal, 0.45F, 0.35F, 0.03F));
  builder.box({-0.1F, -0.06F, 0.95F}, {-0.04F, 0.06F, 1.2F});
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeBollard() {
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.03F));
  lathe(builder,
        {{0.0F, 0.085F},
         {0.08F, 0.085F},
         {0.1F, 0.06F},
         {0.68F, 0.055F},
         {0.7F, 0.075F},
         {0.75F, 0.075F},
         {0.75F, 0.06F}},
        kUpright, 14);
  builder.use(plain(Material::kSign, 0.75F));
  lathe(builder, {{0.75F, 0.06F}, {0.83F, 0.06F}}, kUpright, 14);
  builder.use(plain(Material::kPaintedMetal, 0.03F));
  lathe(builder, {{0.83F, 0.07F}, {0.9F, 0.065F}, {0.95F, 0.04F}, {0.965F, 0.001F}}, kUpright, 14);
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeBin() {
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.02F, 0.06F, 0.035F));
  lathe(builder,
        {{0.0F, 0.2F}, {0.06F, 0.2F}, {0.07F, 0.23F}, {0.78F, 0.25F}, {0.8F, 0.265F}, {0.84F, 0.265F}},
        kUpright, 20);
  builder.use(plain(Material::kPlastic, 0.004F));
  lathe(builder, {{0.84F, 0.265F}, {0.84F, 0.2F}, {0.98F, 0.2F}}, kUpright, 20);
  for (const float turn : {0.125F, 0.375F, 0.625F, 0.875F}) {
    const Vector3f foot(0.235F * std::cos(turn * kTwoPi), 0.235F * std::sin(turn * kTwoPi), 0.82F);
    builder.use(plain(Material::kPaintedMetal, 0.02F, 0.06F, 0.035F));
    builder.cone(foot, foot + Vector3f(0, 0, 0.18F), 0.022F, 0.022F, 6, false);
  }
  lathe(builder, {{0.98F, 0.2F}, {0.98F, 0.27F}, {1.02F, 0.265F}, {1.09F, 0.14F}, {1.1F, 0.001F}}, kUpright,
        20);
  builder.use(plain(Material::kPaintedMetal, 0.5F, 0.4F, 0.08F));
  lathe(builder, {{0.6F, 0.249F}, {0.63F, 0.25F}}, kUpright, 20);
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeBench() {
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.03F));
  for (const float x : {-0.7F, 0.7F}) {
    bar(builder, {x, 0.2F, 0.0F}, {x, 0.18F, 0.43F}, Vector3f::UnitY(), 0.05F, 0.05F);
    bar(builder, {x, -0.25F, 0.0F}, {x, -0.2F, 0.43F}, Vector3f::UnitY(), 0.05F, 0.05F);
    bar(builder, {x, -0.22F, 0.41F}, {x, 0.25F, 0.41F}, Vector3f::UnitZ(), 0.05F, 0.04F);
    bar(builder, {x, -0.2F, 0.42F}, {x, -0.34F, 0.85F}, Vector3f::UnitY(), 0.05F, 0.04F);
    bar(builder, {x, -0.25F, 0.62F}, {x, 0.22F, 0.62F}, Vector3f::UnitZ(), 0.05F, 0.03F);
    bar(builder, {x, 0.19F, 0.43F}, {x, 0.2F, 0.62F}, Vector3f::UnitY(), 0.04F, 0.04F);
  }
  builder.use(plain(Material::kWood, 0.22F, 0.12F, 0.06F));
  for (int slat = 0; slat < 5; ++slat) {
    const float y = -0.17F + 0.095F * static_cast<float>(slat);
    builder.box({-0.9F, y - 0.038F, 0.43F}, {0.9F, y + 0.038F, 0.46F});
  }
  for (int slat = 0; slat < 3; ++slat) {
    const float share = 0.25F + 0.32F * static_cast<float>(slat);
    const Vector3f middle(0, -0.18F - 0.14F * share, 0.44F + 0.43F * share);
    bar(builder, middle - Vector3f(0.9F, 0, 0), middle + Vector3f(0.9F, 0, 0), {0, 0.95F, 0.31F}, 0.09F,
        0.03F);
  }
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeRailing(double length) {
  const auto end = static_cast<float>(length);
  const int bays = std::max(1, static_cast<int>(std::lround(length / 2.0)));
  const int bars = std::max(1, static_cast<int>(std::lround(length / 0.13)));
  MeshBuilder builder;
  builder.use(plain(Material::kPaintedMetal, 0.3F, 0.31F, 0.31F));
  for (int post = 0; post <= bays; ++post) {
    const float x = end * static_cast<float>(post) / static_cast<float>(bays);
    builder.cone({x, 0, 0}, {x, 0, 1.06F}, 0.03F, 0.03F, 10);
  }
  for (const float z : {0.14F, 1.02F}) builder.cone({0, 0, z}, {end, 0, z}, 0.024F, 0.024F, 10);
  for (int number = 1; number < bars; ++number) {
    const float x = end * static_cast<float>(number) / static_cast<float>(bars);
    builder.cone({x, 0, 0.14F}, {x, 0, 1.02F}, 0.009F, 0.009F, 5, false);
  }
  return share(std::move(builder));
}

}  // namespace radar_dot::simulation
