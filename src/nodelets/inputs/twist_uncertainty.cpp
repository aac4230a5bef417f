// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/twist_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "nodelets/inputs/twist_history.h"

namespace radar_dot {

MotionUncertainty motionUncertainty(const MotionUncertainty& configured,
                                    const geometry_msgs::TwistWithCovariance::_covariance_type& covariance,
                                    bool has_rotation) {
  MotionUncertainty uncertainty = configured;
  const auto widen = [&covariance](std::size_t axis, double& deviation) {
    constexpr std::size_t kAxes = 6;
    const double variance = covariance[axis * kAxes + axis];
    if (variance < kUnobservedVariance) deviation = std::max(deviation, std::sqrt(std::max(variance, 0.0)));
  };
  constexpr std::size_t kForward = 0, kLateral = 1, kVertical = 2, kYaw = 5;
  widen(kForward, uncertainty.forward_velocity_std);
  widen(kLateral, uncertainty.lateral_velocity_std);
  widen(kVertical, uncertainty.vertical_velocity_std);
  if (!has_rotation) widen(kYaw, uncertainty.yaw_rate_std);
  return uncertainty;
}

}  // namespace radar_dot
