// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

struct WeightedColor {
  double weight;
  float red, green, blue;
};

template <std::size_t Count>
Color pick(const std::array<WeightedColor, Count>& colors, RandomStream& random, float spread) {
  double total = 0.0;
  for (const WeightedColor& color : colors) total += color.weight;
  double rest = random.uniform(0.0, total);
  const float light = uniform(random, 1.0F - spread, 1.0F + spread);
  for (const WeightedColor& color : colors) {
    rest -= color.weight;
    if (rest < 0.0) return (Color(color.red, color.green, color.blue) * light).min(0.9F);
  }
  return Color::Constant(0.5F);
}

constexpr std::array<WeightedColor, 11> kCarPaints = {{{24, 0.75F, 0.75F, 0.74F},     // white
                                                       {20, 0.17F, 0.175F, 0.18F},    // grey
                                                       {18, 0.015F, 0.015F, 0.017F},  // black
                                                       {14, 0.42F, 0.43F, 0.44F},     // silver
                                                       {9, 0.02F, 0.06F, 0.2F},       // blue
                                                       {4, 0.01F, 0.025F, 0.07F},     // midnight blue
                                                       {6, 0.38F, 0.02F, 0.02F},      // red
                                                       {2, 0.03F, 0.09F, 0.05F},      // green
                                                       {2, 0.25F, 0.18F, 0.11F},      // beige
                                                       {1, 0.6F, 0.22F, 0.02F},       // orange
                                                       {1, 0.6F, 0.45F, 0.05F}}};     // yellow
constexpr std::array<WeightedColor, 4> kBusPaints = {
    {{4, 0.55F, 0.42F, 0.04F}, {3, 0.45F, 0.03F, 0.03F}, {3, 0.7F, 0.7F, 0.7F}, {2, 0.03F, 0.16F, 0.3F}}};
constexpr std::array<WeightedColor, 4> kLoads = {
    {{6, 0.72F, 0.72F, 0.7F}, {2, 0.04F, 0.1F, 0.28F}, {2, 0.5F, 0.33F, 0.04F}, {2, 0.05F, 0.2F, 0.1F}}};
constexpr std::array<WeightedColor, 10> kCoats = {{{6, 0.02F, 0.02F, 0.022F},
                                                   {4, 0.025F, 0.035F, 0.08F},
                                                   {4, 0.12F, 0.12F, 0.125F},
                                                   {3, 0.09F, 0.08F, 0.045F},
                                                   {2, 0.35F, 0.04F, 0.04F},
                                                   {2, 0.3F, 0.22F, 0.13F},
                                                   {2, 0.55F, 0.53F, 0.5F},
                                                   {1, 0.05F, 0.2F, 0.3F},
                                                   {1, 0.5F, 0.3F, 0.03F},
                                                   {1, 0.04F, 0.15F, 0.06F}}};
constexpr std::array<WeightedColor, 5> kTrousers = {{{4, 0.03F, 0.05F, 0.11F},
                                                     {4, 0.018F, 0.018F, 0.02F},
                                                     {2, 0.1F, 0.1F, 0.1F},
                                                     {2, 0.2F, 0.16F, 0.1F},
                                                     {1, 0.07F, 0.11F, 0.2F}}};
constexpr std::array<WeightedColor, 4> kSkins = {
    {{4, 0.5F, 0.31F, 0.22F}, {3, 0.42F, 0.25F, 0.17F}, {2, 0.2F, 0.1F, 0.06F}, {1, 0.08F, 0.04F, 0.025F}}};
constexpr std::array<WeightedColor, 5> kHairs = {{{5, 0.02F, 0.014F, 0.01F},
                                                  {4, 0.06F, 0.035F, 0.018F},
                                                  {2, 0.22F, 0.14F, 0.06F},
                                                  {2, 0.3F, 0.3F, 0.29F},
                                                  {1, 0.15F, 0.05F, 0.02F}}};
constexpr float kDarkSkin = 0.2F;  // mean reflectance below which hair is dark or grey
constexpr std::array<WeightedColor, 2> kDarkHairs = {{{6, 0.015F, 0.012F, 0.01F}, {1, 0.3F, 0.3F, 0.29F}}};

}  // namespace

Palette randomPalette(const Model& model, RandomStream& random) {
  Palette palette;
  if (model.category == "vehicle.car") {
    palette.fill(pick(kCarPaints, random, 0.12F));
  } else if (model.category == "vehicle.bus.rigid") {
    palette.fill(pick(kBusPaints, random, 0.1F));
    palette[3] = random.chance(0.5) ? palette[0] : Color(pick(kLoads, random, 0.1F));
  } else if (model.category == "vehicle.truck") {
    palette.fill(pick(kCarPaints, random, 0.12F));
    palette[3] = pick(kLoads, random, 0.1F);
  } else {
    palette[0] = pick(kCoats, random, 0.25F);
    palette[1] = pick(kTrousers, random, 0.25F);
    palette[2] = pick(kSkins, random, 0.15F);
    palette[3] = palette[2].mean() > kDarkSkin ? pick(kHairs, random, 0.2F) : pick(kDarkHairs, random, 0.2F);
  }
  return palette;
}

}  // namespace radar_dot::simulation
