// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

namespace radar_dot {

/// From one state of splitmix64 to the next.
inline constexpr std::uint64_t kRandomStep = 0x9e3779b97f4a7c15ULL;

/// Mixes the bits of a number: splitmix64, the same on every platform.
inline std::uint64_t mixBits(std::uint64_t value) noexcept {
  value += kRandomStep;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

/// A stream of random numbers that depends on nothing but its seeds: every reading has a stream of
/// its own, so results do not depend on the order of the work or the number of threads. Its
/// distributions are written out, because those of the standard library differ between libraries.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0) noexcept
      : state_(mixBits(mixBits(seed) ^ (stream * 0xd1342543de82ef95ULL))) {}

  std::uint64_t bits() noexcept { return mixBits(state_ += kRandomStep); }
  /// In [0, 1).
  double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// In 0..count-1.
  int index(int count) noexcept { return static_cast<int>(uniform() * count); }
  bool chance(double probability) noexcept { return uniform() < probability; }
  /// Standard normal (Box-Muller).
  double normal() noexcept {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(6.283185307179586 * uniform());
  }
  double normal(double mean, double deviation) noexcept { return mean + deviation * normal(); }
  /// Knuth for small means, normal approximation above 30.
  int poisson(double mean) noexcept {
    if (mean > 30.0) return static_cast<int>(std::fmax(0.0, std::round(normal(mean, std::sqrt(mean)))));
    const double limit = std::exp(-mean);
    int count = 0;
    for (double product = uniform(); product > limit; product *= uniform()) ++count;
    return count;
  }

 private:
  std::uint64_t state_;
};

}  // namespace radar_dot
