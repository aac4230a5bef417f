// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace radar_dot {

/// The end of a refusal of an unknown name: "; did you mean X?", or nothing where no known name is like it.
/// @param nearest  see nearestName
/// @param quote    around the name
inline std::string didYouMean(const std::string& nearest, const char* quote = "") {
  return nearest.empty() ? nearest : "; did you mean " + (quote + nearest + quote) + "?";
}

}  // namespace radar_dot
