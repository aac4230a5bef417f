// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace radar_dot {

/// Refuses parameters of one part of the package by name.
/// @throws std::invalid_argument "<part>: <name> is <value>, must be <wanted>".
class ParameterChecks {
 public:
  explicit ParameterChecks(const char* part) : part_(part) {}

  void require(bool good, const char* name, double value, const char* wanted) const {
    if (!good)
      throw std::invalid_argument(fmt::format("{}: {} is {}, must be {}", part_, name, value, wanted));
  }
  void positive(const char* name, double value) const {
    require(std::isfinite(value) && value > 0.0, name, value, "positive");
  }
  void notNegative(const char* name, double value) const {
    require(std::isfinite(value) && value >= 0.0, name, value, "zero or positive");
  }

 private:
  const char* part_;
};

}  // namespace radar_dot
