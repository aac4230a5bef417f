// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "new_token.h"

#include <fmt/format.h>

#include <cstdint>

namespace radar_dot::dataset {
namespace {

/// FNV-1a, with a finisher that spreads the last characters over all bits.
std::uint64_t hash(std::initializer_list<std::string_view> name, std::uint64_t start) {
  constexpr std::uint64_t kPrime = 0x100000001b3ULL;
  constexpr std::uint64_t kPartEnd = 0xff;  // no character of a name, so that {"ab", "c"} is not {"a", "bc"}
  std::uint64_t value = start;
  for (const std::string_view part : name) {
    for (const char character : part) value = (value ^ static_cast<unsigned char>(character)) * kPrime;
    value = (value ^ kPartEnd) * kPrime;
  }
  value = (value ^ value >> 33) * 0xff51afd7ed558ccdULL;
  value = (value ^ value >> 33) * 0xc4ceb9fe1a85ec53ULL;
  return value ^ value >> 33;
}

}  // namespace

std::string newToken(std::initializer_list<std::string_view> name) {
  return fmt::format("{:016x}{:016x}", hash(name, 0xcbf29ce484222325ULL), hash(name, 0x84222325cbf29ce4ULL));
}

}  // namespace radar_dot::dataset
