// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/noise.h"

namespace radar_dot::simulation {
namespace {

constexpr int kOctaves = 8;

/// valueNoise of all octaves in one loop, for the compiler to do them side by side.
[[gnu::always_inline]] inline void noiseOf(float x, float y, std::uint32_t seed, float* values) noexcept {
  for (int i = 0; i < kOctaves; ++i) {
    const auto scale = static_cast<float>(1 << i);
    values[i] = valueNoise(scale * x, scale * y, seed + static_cast<std::uint32_t>(i));
  }
}

void baseNoise(float x, float y, std::uint32_t seed, float* values) noexcept { noiseOf(x, y, seed, values); }

#if defined(__x86_64__)
// Without fused multiply-add, which would round otherwise.
[[gnu::target("avx2")]] void wideNoise(float x, float y, std::uint32_t seed, float* values) noexcept {
  noiseOf(x, y, seed, values);
}
const auto allOctaves = __builtin_cpu_supports("avx2") != 0 ? wideNoise : baseNoise;
#else
constexpr auto allOctaves = baseNoise;
#endif

}  // namespace

float fractalNoise(float x, float y, float longest, int octaves, float gain, const PixelFootprint& footprint,
                   std::uint32_t seed) noexcept {
  float wavelength = longest;
  float share = visibleShare(wavelength, footprint);
  if (share <= 0.0F) return 0.0F;  // nor do finer ones
  float values[kOctaves];
  allOctaves(x / longest, y / longest, seed, values);
  float sum = 0.0F;
  float amplitude = 1.0F;
  for (int octave = 0; octave < octaves && share > 0.0F; ++octave) {
    sum += amplitude * share * values[octave];
    amplitude *= gain;
    wavelength *= 0.5F;
    share = visibleShare(wavelength, footprint);
  }
  return sum;
}

}  // namespace radar_dot::simulation
