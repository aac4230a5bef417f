// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "radar_dot/evaluation/pose_track.h"
#include "sweep_velocities.h"

namespace radar_dot::evaluation {

/// The motion of the vehicle as it knows it itself at any time: the latest velocity at or before it, and the
/// path that the velocities add up to.
class OnlineMotion {
 public:
  explicit OnlineMotion(std::vector<EstimatedVelocity> velocities);

  /// Velocity brought to `time`; nothing where the latest is too old.
  std::optional<EstimatedVelocity> velocityAt(double time) const;
  /// Pose in a frame fixed to the world, from velocities up to `time`.
  Eigen::Isometry3d poseAt(double time) const;

 private:
  std::vector<EstimatedVelocity> velocities_;
  std::vector<Eigen::Isometry3d> poses_;  // at the velocities
};

}  // namespace radar_dot::evaluation
