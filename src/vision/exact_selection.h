// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace radar_dot {

/// Order statistics of many floats that are zero or greater, exact, without sorting or copying them: a
/// histogram of their leading bits, whose order is that of the numbers, tells the bin that holds the wanted
/// one; only that bin is looked through. NaN are counted in bins of their own and never chosen.
class FloatHistogram {
 public:
  static constexpr unsigned kShift = 17;
  static constexpr std::uint32_t kInfinity = 0x7F800000U >> kShift;
  static constexpr std::size_t kBins = 0x80000000U >> kShift;

  static std::uint32_t binOf(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7FFFFFFFU) >> kShift;
  }

  void clear() { counts_.fill(0); }
  void add(float value) { ++counts_[binOf(value)]; }
  FloatHistogram& operator+=(const FloatHistogram& other) {
    for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
    return *this;
  }
  /// How many finite numbers there are.
  std::size_t finiteCount() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < kInfinity; ++i) count += counts_[i];
    return count;
  }
  /// Bin of the number of this rank (from 0), which must exist, and how many finite numbers lie below the
  /// bin.
  struct Place {
    std::uint32_t bin = 0;
    std::size_t below = 0;
  };
  Place placeOf(std::size_t rank) const {
    Place place;
    while (place.below + counts_[place.bin] <= rank) place.below += counts_[place.bin++];
    return place;
  }

 private:
  std::array<std::uint32_t, kBins> counts_{};
};

}  // namespace radar_dot
