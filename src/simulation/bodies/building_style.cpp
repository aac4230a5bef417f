// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/building_style.h"

#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

Surface wallSurface(RandomStream& random) {
  const float light = uniform(random, 0.8F, 1.2F);
  const auto tinted = [&](Material material, float red, float green, float blue) {
    return plain(material, light * red, light * green, light * blue);
  };
  switch (random.index(9)) {
    case 0: return tinted(Material::kBrick, 0.35F, 0.13F, 0.08F);
    case 1: return tinted(Material::kBrick, 0.27F, 0.11F, 0.075F);
    case 2: return tinted(Material::kBrick, 0.42F, 0.31F, 0.2F);
    case 3: return tinted(Material::kPlaster, 0.58F, 0.52F, 0.42F);
    case 4: return tinted(Material::kPlaster, 0.6F, 0.45F, 0.26F);
    case 5: return tinted(Material::kPlaster, 0.48F, 0.5F, 0.5F);
    case 6: return tinted(Material::kPlaster, 0.5F, 0.33F, 0.27F);
    case 7: return tinted(Material::kConcrete, 0.36F, 0.35F, 0.33F);
    default: return tinted(Material::kPlaster, 0.65F, 0.63F, 0.58F);
  }
}

}  // namespace

BuildingStyle randomBuildingStyle(RandomStream& random) {
  BuildingStyle style;
  style.wall = wallSurface(random);
  const bool concrete = style.wall.material == Material::kConcrete;
  style.plinth = plain(Material::kConcrete, uniform(random, 0.15F, 0.3F));
  style.trim = plain(Material::kConcrete, uniform(random, 0.4F, 0.6F));
  style.frame = random.chance(0.65) ? plain(Material::kPlastic, 0.72F)
                                    : plain(Material::kPlastic, 0.05F, 0.045F, 0.04F);
  style.pane = plain(Material::kWindowPane, 0.04F, 0.045F, 0.05F);
  style.roof = random.chance(0.5) ? plain(Material::kRoof, 0.24F, 0.09F, 0.06F)
                                  : plain(Material::kRoof, 0.07F, 0.07F, 0.08F);
  constexpr float kDoors[][3] = {
      {0.1F, 0.05F, 0.03F}, {0.02F, 0.06F, 0.04F}, {0.03F, 0.04F, 0.1F}, {0.2F, 0.03F, 0.03F}};
  const auto& door = kDoors[random.index(4)];
  style.door = plain(Material::kWood, door[0], door[1], door[2]);
  constexpr float kBold[][3] = {{0.4F, 0.03F, 0.03F},
                                {0.03F, 0.1F, 0.3F},
                                {0.03F, 0.2F, 0.08F},
                                {0.55F, 0.35F, 0.03F},
                                {0.04F, 0.04F, 0.05F}};
  const auto& sign = kBold[random.index(5)];
  style.sign = plain(Material::kPlastic, sign[0], sign[1], sign[2]);
  const auto& awning = kBold[random.index(5)];
  style.awning = plain(Material::kCloth, awning[0], awning[1], awning[2]);
  style.storey = uniform(random, 3.0F, 3.5F);
  style.ground_storey = style.storey + 0.4F;
  style.window_width = concrete ? uniform(random, 1.5F, 2.1F) : uniform(random, 1.0F, 1.4F);
  style.window_height = concrete ? uniform(random, 1.4F, 1.6F) : uniform(random, 1.55F, 1.9F);
  style.setback = uniform(random, 0.1F, 0.18F);
  style.mullions = style.window_width > 1.45F ? 2 : 1;
  style.transom = random.chance(0.5);
  style.pitched = !concrete && random.chance(0.6);
  style.lintels = !concrete && random.chance(0.7);
  style.bands = random.chance(0.4);
  style.balconies = random.chance(0.35) ? 0.4F : 0.0F;
  style.awnings = random.chance(0.5);
  return style;
}

}  // namespace radar_dot::simulation
