// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <vector>

#include "radar_dot/dataset/can_bus.h"

namespace radar_dot::evaluation {

/// Wheel speed at `time` and its mean over an interval, m/s.
class WheelSpeed {
 public:
  explicit WheelSpeed(const std::vector<dataset::CanVehicleInfo>& wheels) : wheels_(wheels) {}
  std::optional<double> at(double time) const {
    const auto stamp = static_cast<std::int64_t>(std::llround(time * 1e6));
    const auto after =
        std::lower_bound(wheels_.begin(), wheels_.end(), stamp,
                         [](const auto& info, std::int64_t t) { return info.timestamp_us < t; });
    if (after == wheels_.begin() || after == wheels_.end()) return std::nullopt;
    const auto before = std::prev(after);
    const double share = static_cast<double>(stamp - before->timestamp_us) /
                         static_cast<double>(after->timestamp_us - before->timestamp_us);
    return (1.0 - share) * dataset::rearAxleSpeed(*before) + share * dataset::rearAxleSpeed(*after);
  }
  std::optional<double> mean(double begin, double end) const {
    constexpr int kSteps = 50;
    double sum = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      const std::optional<double> speed = at(begin + (end - begin) * i / kSteps);
      if (!speed) return std::nullopt;
      sum += *speed / (kSteps + 1);
    }
    return sum;
  }

 private:
  const std::vector<dataset::CanVehicleInfo>& wheels_;
};

}  // namespace radar_dot::evaluation
