// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace radar_dot::simulation {

// Poses as the rows of a dataset hold them.

inline std::array<double, 3> asArray(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// w x y z
inline std::array<double, 4> quaternionOf(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace radar_dot::simulation
