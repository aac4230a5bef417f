// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {
namespace {

constexpr double kStep = 1e-4;  // s

}  // namespace

Eigen::Vector3d Trajectory::velocity(double time_s) const {
  return (at(time_s + kStep).T_map_from_body.translation() -
          at(time_s - kStep).T_map_from_body.translation()) /
         (2.0 * kStep);
}

Eigen::Vector3d Trajectory::angularVelocity(double time_s) const {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(at(time_s + kStep).T_map_from_body.linear() *
                                               at(time_s - kStep).T_map_from_body.linear().transpose()));
  return turn.angle() / (2.0 * kStep) * turn.axis();
}

}  // namespace radar_dot::simulation
