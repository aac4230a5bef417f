// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace radar_dot::simulation {

/// Size on a surface of what one pixel sees, m.
struct PixelFootprint {
  float across = 0.001F;  ///< the short way
  float along = 0.001F;   ///< the long way, where the surface is seen at a grazing angle
};

[[gnu::always_inline]] inline std::uint32_t hashBits(std::int32_t x, std::int32_t y,
                                                     std::uint32_t seed) noexcept {
  std::uint32_t bits = seed + static_cast<std::uint32_t>(x) * 0x9e3779b1U;
  bits = (bits ^ (bits >> 15)) * 0x85ebca77U;
  bits += static_cast<std::uint32_t>(y) * 0xc2b2ae3dU;
  bits = (bits ^ (bits >> 13)) * 0x27d4eb2fU;
  return bits ^ (bits >> 16);
}

/// In [0, 1).
[[gnu::always_inline]] inline float hashUnit(std::int32_t x, std::int32_t y, std::uint32_t seed) noexcept {
  return static_cast<float>(hashBits(x, y, seed) >> 8) * 0x1.0p-24F;
}

inline float smoothStep(float low, float high, float value) noexcept {
  const float t = std::clamp((value - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// std::floor without the library call that it is on the oldest x86-64.
[[gnu::always_inline]] inline std::int32_t floorOf(float value) noexcept {
  const auto truncated = static_cast<std::int32_t>(value);
  return truncated - (static_cast<float>(truncated) > value ? 1 : 0);
}

/// Smooth noise with features one unit apart, in [-1, 1].
[[gnu::always_inline]] inline float valueNoise(float x, float y, std::uint32_t seed) noexcept {
  const std::int32_t ix = floorOf(x);
  const std::int32_t iy = floorOf(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float wx = fx * fx * (3.0F - 2.0F * fx);
  const float wy = fy * fy * (3.0F - 2.0F * fy);
  const float low = hashUnit(ix, iy, seed) * (1.0F - wx) + hashUnit(ix + 1, iy, seed) * wx;
  const float high = hashUnit(ix, iy + 1, seed) * (1.0F - wx) + hashUnit(ix + 1, iy + 1, seed) * wx;
  return 2.0F * (low * (1.0F - wy) + high * wy) - 1.0F;
}

/// How much of a pattern of this wavelength survives the averaging within a pixel: all of it when it
/// is much longer than the footprint, nothing when shorter than the short way, and what averaging
/// over independent features leaves when only the long way spans many.
inline float visibleShare(float wavelength, const PixelFootprint& footprint) noexcept {
  const float sharp = std::clamp(0.5F * wavelength / footprint.across - 1.0F, 0.0F, 1.0F);
  return footprint.along > wavelength ? sharp * std::sqrt(wavelength / footprint.along) : sharp;
}

/// Noise with details from `longest` (m) over `octaves` halvings, 8 at most, each `gain` times as strong as
/// the one before; what a pixel cannot resolve is left out. About in [-1, 1], and the same on every machine.
float fractalNoise(float x, float y, float longest, int octaves, float gain, const PixelFootprint& footprint,
                   std::uint32_t seed) noexcept;

/// Fraction of a pixel that a line of `width` around position 0 covers when the pixel's box of `size` is
/// centred at `position` (all m).
inline float lineCoverage(float position, float width, float size) noexcept {
  const float low = std::max(position - 0.5F * size, -0.5F * width);
  const float high = std::min(position + 0.5F * size, 0.5F * width);
  return std::clamp((high - low) / size, 0.0F, 1.0F);
}

}  // namespace radar_dot::simulation
