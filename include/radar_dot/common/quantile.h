// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace radar_dot {

/// The value that `share` (0..1) of the others are below; the median, without one, is the upper of the two in
/// the middle. @param values  finite; reordered. @return 0 of none
template <typename T>
T quantileOf(std::vector<T>& values, double share = 0.5) {
  if (values.empty()) return T(0);
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace radar_dot
