// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

namespace radar_dot::simulation {

/// Two unit vectors that make a right-handed frame with a unit `axis`, in the order x, y, axis.
inline std::pair<Eigen::Vector3f, Eigen::Vector3f> acrossOf(const Eigen::Vector3f& axis) {
  const Eigen::Vector3f helper =
      std::abs(axis.z()) < 0.9F ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX();
  const Eigen::Vector3f x = helper.cross(axis).normalized();
  return {x, axis.cross(x)};
}

}  // namespace radar_dot::simulation
