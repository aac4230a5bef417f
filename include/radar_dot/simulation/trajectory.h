// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace radar_dot::simulation {

/// Where a body is at one time.
struct BodyState {
  Eigen::Isometry3d T_map_from_body = Eigen::Isometry3d::Identity();
  double distance = 0.0;        ///< m, travelled along the path since time 0
  double speed = 0.0;           ///< m/s along the path
  double steering_angle = 0.0;  ///< rad, of the front wheels, positive to the left
};

/// Rate at which a body turned from one pose to another `interval` seconds later, rad/s, in the frame that
/// the poses refer to.
Eigen::Vector3d rotationRate(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after,
                             double interval);

/// The motion of a rigid body as a smooth function of time, defined for every time (bodies stand or
/// go on outside the time they were planned for). Body frame: x ahead, y left, z up (REP 103).
class Trajectory {
 public:
  virtual ~Trajectory() = default;
  virtual BodyState at(double time_s) const = 0;

  /// Of the body's origin, map frame, m/s: central difference over 0.2 ms.
  Eigen::Vector3d velocity(double time_s) const;
  /// Map frame, rad/s.
  Eigen::Vector3d angularVelocity(double time_s) const;
};

/// A body that never moves.
class Standing final : public Trajectory {
 public:
  explicit Standing(const Eigen::Isometry3d& T_map_from_body) : T_map_from_body_(T_map_from_body) {}
  BodyState at(double) const override { return {T_map_from_body_, 0.0, 0.0, 0.0}; }

 private:
  Eigen::Isometry3d T_map_from_body_;
};

}  // namespace radar_dot::simulation
