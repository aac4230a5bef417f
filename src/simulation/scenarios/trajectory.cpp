// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {
namespace {

constexpr double kStep = 1e-4;  // s

}  // namespace

Eigen::Vector3d rotationRate(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after,
                             double interval) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.linear() * before.linear().transpose()));
  return turn.angle() / interval * turn.axis();
}

Eigen::Vector3d Trajectory::velocity(double time_s) const {
  return (at(time_s + kStep).T_map_from_body.translation() -
          at(time_s - kStep).T_map_from_body.translation()) /
         (2.0 * kStep);
}

Eigen::Vector3d Trajectory::angularVelocity(double time_s) const {
  return rotationRate(at(time_s - kStep).T_map_from_body, at(time_s + kStep).T_map_from_body, 2.0 * kStep);
}

}  // namespace radar_dot::simulation
