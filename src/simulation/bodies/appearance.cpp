// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/appearance.h"

#include <cmath>

namespace radar_dot::simulation {
namespace {

/// Coordinates within the plane that the surface is most parallel to, m. On walls the second is height.
struct Planar {
  float a = 0.0F;
  float b = 0.0F;
};

Planar planarOf(const SurfacePoint& point) {
  const Eigen::Array3f weight = point.normal.array().abs();
  const Eigen::Vector3f& p = point.position;
  if (weight.z() > weight.x() && weight.z() > weight.y()) return {p.x(), p.y()};
  return weight.x() > weight.y() ? Planar{p.y(), p.z()} : Planar{p.x(), p.z()};
}

/// `amplitude` of change in brightness; never negative.
Color varied(const Color& color, float change) { return color * std::max(0.05F, 1.0F + change); }

Color mixed(const Color& from, const Color& to, float share) { return from + (to - from) * share; }

/// Distance to the nearest multiple of `period`, m, signed.
float offsetInPeriod(float value, float period) {
  return value - period * static_cast<float>(floorOf(value / period + 0.5F));
}

Appearance asphalt(const Color& color, const SurfacePoint& point) {
  const auto [x, y] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  const float patches = fractalNoise(x, y, 9.0F, 3, 0.6F, f, 11);
  const float blotches = fractalNoise(x + 3.7F, y, 0.9F, 3, 0.75F, f, 29);
  const float grain = fractalNoise(x, y + 1.3F, 0.11F, 5, 0.9F, f, 47);
  Appearance look;
  look.albedo = varied(color, 0.16F * patches + 0.17F * blotches + 0.20F * grain);
  // Light chippings stand out of the binder.
  const float chips = visibleShare(0.03F, f);
  if (chips > 0.0F)
    look.albedo += 0.05F * chips * smoothStep(0.45F, 0.8F, valueNoise(x / 0.013F, y / 0.013F, 83));
  // Cracks sealed with tar run where a smooth field changes its sign.
  const float wander = 0.6F * fractalNoise(x, y, 1.7F, 3, 0.5F, f, 61);
  const float crack = std::abs(valueNoise(x / 4.3F, y / 4.3F, 71) + 0.25F * wander);
  const float width = 0.006F + 0.35F * f.across;
  look.albedo *=
      1.0F - 0.55F * std::min(1.0F, 0.008F / width) * (1.0F - smoothStep(0.5F * width, 1.5F * width, crack));
  look.highlight = 0.04F;
  look.highlight_exponent = 8.0F;
  return look;
}

Appearance lanePaint(const Color& color, const SurfacePoint& point) {
  const auto [x, y] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  const float worn = fractalNoise(x, y, 0.5F, 6, 0.75F, f, 103);
  Appearance look;
  look.albedo = mixed(varied(color, 0.08F * fractalNoise(x, y, 0.06F, 3, 0.8F, f, 107)),
                      Color::Constant(0.11F), 0.75F * smoothStep(0.25F, 0.85F, worn));
  look.highlight = 0.05F;
  look.highlight_exponent = 10.0F;
  return look;
}

Appearance pavement(const Color& color, const SurfacePoint& point) {
  constexpr float kSlab = 0.5F;
  constexpr float kJoint = 0.012F;
  const auto [x, y] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  const auto column = floorOf(x / kSlab);
  const float shifted = y + ((column & 1) != 0 ? 0.5F * kSlab : 0.0F);
  const auto row = floorOf(shifted / kSlab);
  const float resolved = visibleShare(kSlab, f);
  const float tone = resolved * (hashUnit(column, row, 131) - 0.5F);
  const float joint =
      std::max(lineCoverage(offsetInPeriod(x, kSlab), kJoint, std::max(f.across, 0.002F)),
               lineCoverage(offsetInPeriod(shifted, kSlab), kJoint, std::max(f.across, 0.002F)));
  Appearance look;
  look.albedo = varied(color, 0.30F * tone + 0.10F * fractalNoise(x, y, 0.07F, 5, 0.85F, f, 137) +
                                  0.20F * fractalNoise(x, y, 3.0F, 4, 0.65F, f, 139));
  look.albedo *= 1.0F - 0.55F * resolved * joint;
  // Chewing gum and stains.
  const float spot = hashUnit(floorOf(x / 0.11F), floorOf(y / 0.11F), 149);
  if (spot > 0.93F) look.albedo *= 1.0F - 0.4F * visibleShare(0.11F, f);
  return look;
}

Appearance rough(const Color& color, const SurfacePoint& point, float fine, float coarse) {
  const auto [a, b] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  Appearance look;
  look.albedo = varied(color, fine * fractalNoise(a, b, 0.14F, 4, 0.8F, f, point.object_seed + 1) +
                                  coarse * fractalNoise(a, b, 3.1F, 3, 0.65F, f, point.object_seed + 2));
  return look;
}

Appearance brick(const Color& color, const SurfacePoint& point) {
  constexpr float kLength = 0.25F;
  constexpr float kHeight = 0.083F;
  constexpr float kMortar = 0.012F;
  const auto [a, b] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  const auto row = floorOf(b / kHeight);
  const float shifted = a + ((row & 1) != 0 ? 0.5F * kLength : 0.0F);
  const auto column = floorOf(shifted / kLength);
  const float pixel = std::max(f.across, 0.001F);
  const float mortar = std::max(lineCoverage(offsetInPeriod(shifted, kLength), kMortar, pixel),
                                lineCoverage(offsetInPeriod(b, kHeight), kMortar, pixel));
  const float resolved = visibleShare(kHeight, f);
  Appearance look = rough(color, point, 0.10F, 0.22F);
  look.albedo =
      varied(look.albedo.matrix().array(), (0.55F * resolved + 0.1F * visibleShare(3.0F * kHeight, f)) *
                                               (hashUnit(column, row, point.object_seed) - 0.5F));
  look.albedo = mixed(look.albedo, Color(0.42F, 0.40F, 0.37F), resolved * mortar + (1.0F - resolved) * 0.16F);
  return look;
}

Appearance plaster(const Color& color, const SurfacePoint& point) {
  const auto [a, b] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  Appearance look = rough(color, point, 0.10F, 0.14F);
  // Rain leaves streaks that are long and thin.
  const float streaks = fractalNoise(a, 0.12F * b, 0.9F, 4, 0.75F, f, point.object_seed + 5);
  look.albedo *= 1.0F - 0.28F * smoothStep(-0.1F, 1.0F, streaks);
  return look;
}

Appearance pane(const Color& color, const SurfacePoint& point, bool shop) {
  const float kind = hashUnit(static_cast<std::int32_t>(point.patch_seed), 3, 171);
  const auto [a, b] = planarOf(point);
  Appearance look;
  // A dark room, a blind, or curtains with folds.
  look.albedo = color * (0.06F + 0.10F * kind);
  if (!shop && kind > 0.55F) {
    const float folds = fractalNoise(a, 0.05F * b, 0.16F, 3, 0.6F, point.footprint, point.patch_seed);
    look.albedo = varied(Color(0.42F, 0.40F, 0.36F) * (0.5F + kind), 0.35F * folds);
  } else if (shop) {
    // Goods on shelves.
    const float goods = hashUnit(floorOf(a / 0.23F), floorOf(b / 0.31F), point.object_seed);
    const float hue = hashUnit(floorOf(a / 0.23F), floorOf(b / 0.31F), point.object_seed + 9);
    const Color shelf(0.12F + 0.30F * goods * hue, 0.11F + 0.22F * goods,
                      0.10F + 0.28F * goods * (1.0F - hue));
    look.albedo = mixed(Color::Constant(0.14F), shelf, visibleShare(0.25F, point.footprint));
  }
  look.mirror = 0.09F;
  look.bump = 0.004F;
  if (point.night) {
    const bool lit = shop || hashUnit(static_cast<std::int32_t>(point.patch_seed), 5, 173) > 0.62F;
    if (lit) look.emission = look.albedo * Color(1.0F, 0.78F, 0.5F) * (shop ? 4.0F : 2.2F);
  }
  return look;
}

Appearance foliage(const Color& color, const SurfacePoint& point) {
  const auto patch = static_cast<std::int32_t>(point.patch_seed);
  const float tone = hashUnit(patch, 7, point.object_seed) - 0.5F;
  Appearance look;
  look.albedo = varied(color, 0.7F * tone);
  look.albedo.x() *= 1.0F + 0.5F * (hashUnit(patch, 8, point.object_seed) - 0.5F);
  look.translucency = 0.45F;
  look.highlight = 0.05F;
  look.highlight_exponent = 12.0F;
  return look;
}

Appearance grass(const Color& color, const SurfacePoint& point) {
  const auto [x, y] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  const float blades = fractalNoise(x, y, 0.16F, 5, 0.9F, f, 211);
  const float meadow = fractalNoise(x, y, 6.0F, 5, 0.7F, f, 223);
  Appearance look;
  look.albedo = varied(color, 0.28F * blades + 0.25F * meadow);
  look.albedo = mixed(look.albedo, Color(0.20F, 0.15F, 0.09F), 0.6F * smoothStep(0.3F, 1.0F, meadow));
  return look;
}

Appearance bark(const Color& color, const SurfacePoint& point) {
  const auto [a, b] = planarOf(point);
  Appearance look;
  look.albedo =
      varied(color, 0.45F * fractalNoise(a, 0.25F * b, 0.06F, 4, 0.8F, point.footprint, point.object_seed));
  return look;
}

Appearance carPaint(const Color& color, const SurfacePoint& point) {
  const auto [a, b] = planarOf(point);
  Appearance look;
  const float dust = fractalNoise(a, b, 0.7F, 4, 0.7F, point.footprint, point.object_seed);
  look.albedo = mixed(color, Color(0.30F, 0.27F, 0.23F),
                      0.06F + 0.10F * smoothStep(0.9F, 0.1F, point.position.z()) * (1.0F + dust));
  look.mirror = 0.045F;
  look.highlight = 0.35F;
  look.highlight_exponent = 120.0F;
  look.bump = 0.002F;
  return look;
}

Appearance carGlass(const SurfacePoint& point) {
  Appearance look;
  const auto [a, b] = planarOf(point);
  // Seats and people, seen dimly.
  look.albedo = Color(0.035F, 0.038F, 0.040F) *
                (1.0F + 0.6F * fractalNoise(a, b, 0.5F, 2, 0.6F, point.footprint, point.object_seed));
  look.mirror = 0.075F;
  look.highlight = 0.4F;
  look.highlight_exponent = 200.0F;
  return look;
}

Appearance cloth(const Color& color, const SurfacePoint& point) {
  const auto [a, b] = planarOf(point);
  const PixelFootprint& f = point.footprint;
  Appearance look;
  look.albedo = varied(color, 0.28F * fractalNoise(a, 0.6F * b, 0.11F, 4, 0.7F, f, point.object_seed));
  const std::uint32_t pattern = point.object_seed % 4U;
  if (pattern < 2) {
    const float period = pattern == 0 ? 0.07F : 0.11F;
    const float stripe =
        lineCoverage(offsetInPeriod(pattern == 0 ? b : a, period), 0.4F * period, std::max(f.across, 0.002F));
    look.albedo = mixed(look.albedo, 0.45F * color + 0.18F, 0.7F * stripe * visibleShare(period, f));
  }
  return look;
}

Appearance glossy(const Color& color, const SurfacePoint& point, float mirror, float highlight) {
  Appearance look = rough(color, point, 0.05F, 0.08F);
  look.mirror = mirror;
  look.highlight = highlight;
  look.highlight_exponent = 60.0F;
  return look;
}

Appearance shining(const Color& color, const SurfacePoint& point, float radiance) {
  Appearance look = glossy(color, point, 0.05F, 0.2F);
  if (point.night) look.emission = color * radiance;
  return look;
}

Appearance roof(const Color& color, const SurfacePoint& point) {
  constexpr float kTile = 0.3F;
  const auto [a, b] = planarOf(point);
  Appearance look = rough(color, point, 0.12F, 0.2F);
  const float shade = offsetInPeriod(b, kTile) / kTile;
  look.albedo = varied(look.albedo, 0.5F * visibleShare(kTile, point.footprint) * shade);
  look.albedo = varied(look.albedo, 0.2F * visibleShare(kTile, point.footprint) *
                                        (hashUnit(floorOf(a / kTile), floorOf(b / kTile), 241) - 0.5F));
  return look;
}

Appearance wood(const Color& color, const SurfacePoint& point) {
  const auto [a, b] = planarOf(point);
  Appearance look;
  look.albedo =
      varied(color, 0.30F * fractalNoise(0.12F * a, b, 0.05F, 4, 0.7F, point.footprint, point.object_seed));
  return look;
}

}  // namespace

bool isGround(Material material) noexcept {
  return material == Material::kAsphalt || material == Material::kLanePaint ||
         material == Material::kPavement || material == Material::kKerb || material == Material::kGrass ||
         material == Material::kSoil;
}

Appearance appearanceOf(Material material, const Color& color, const SurfacePoint& point) {
  switch (material) {
    case Material::kAsphalt: return asphalt(color, point);
    case Material::kLanePaint: return lanePaint(color, point);
    case Material::kPavement: return pavement(color, point);
    case Material::kKerb: return rough(color, point, 0.16F, 0.2F);
    case Material::kConcrete: return plaster(color, point);
    case Material::kBrick: return brick(color, point);
    case Material::kPlaster: return plaster(color, point);
    case Material::kRoof: return roof(color, point);
    case Material::kWindowPane: return pane(color, point, false);
    case Material::kShopWindow: return pane(color, point, true);
    case Material::kWood: return wood(color, point);
    case Material::kFoliage: return foliage(color, point);
    case Material::kBark: return bark(color, point);
    case Material::kGrass: return grass(color, point);
    case Material::kSoil: return rough(color, point, 0.25F, 0.25F);
    case Material::kCarPaint: return carPaint(color, point);
    case Material::kCarGlass: return carGlass(point);
    case Material::kPlastic: return glossy(color, point, 0.0F, 0.05F);
    case Material::kTyre: return rough(color, point, 0.15F, 0.1F);
    case Material::kRim: return glossy(color, point, 0.10F, 0.3F);
    case Material::kChrome: return glossy(0.3F * color, point, 0.55F, 0.6F);
    case Material::kHeadLamp: return shining(color, point, 14.0F);
    case Material::kTailLamp: return shining(color, point, 2.5F);
    case Material::kNumberPlate: return glossy(color, point, 0.0F, 0.1F);
    case Material::kPaintedMetal: return glossy(color, point, 0.0F, 0.15F);
    case Material::kSign: return glossy(color, point, 0.0F, 0.1F);
    case Material::kStreetLamp: return shining(color, point, 20.0F);
    case Material::kSkin: return rough(color, point, 0.08F, 0.05F);
    case Material::kHair: return rough(color, point, 0.35F, 0.05F);
    case Material::kCloth: return cloth(color, point);
    case Material::kLeather: return glossy(color, point, 0.0F, 0.08F);
  }
  return {};
}

}  // namespace radar_dot::simulation
