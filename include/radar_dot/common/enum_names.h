// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace radar_dot {

/// One value of an enum: its name in configuration files, on command lines and in messages.
template <typename Enum>
struct EnumName {
  Enum value;
  const char* name;
  const char* text = "";  ///< one sentence for help and documentation
};

/// The names of an enum, specialised next to it:
///     template <>
///     struct EnumNames<Solver> {
///       static constexpr EnumName<Solver> kValues[] = {{Solver::kRansac, "ransac", "consensus, ..."}, ...};
///     };
template <typename Enum>
struct EnumNames;

/// The name of a value; "unknown" for one outside the enum.
template <typename Enum, typename = decltype(EnumNames<Enum>::kValues)>
constexpr std::string_view toString(Enum value) noexcept {
  for (const EnumName<Enum>& each : EnumNames<Enum>::kValues)
    if (each.value == value) return each.name;
  return "unknown";
}

/// Inverse of toString. @throws std::invalid_argument listing the names.
template <typename Enum>
Enum fromString(std::string_view name) {
  std::string known;
  for (const EnumName<Enum>& each : EnumNames<Enum>::kValues) {
    if (name == each.name) return each.value;
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  }
  throw std::invalid_argument("'" + std::string(name) + "' is not one of " + known);
}

}  // namespace radar_dot
