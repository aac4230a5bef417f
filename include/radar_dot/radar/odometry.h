// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>

#include "radar_dot/common/stamped_twist.h"

namespace radar_dot {

/// Integrates body velocities to a pose: the paper's
///     p_{t+1} = p_t + R_t v_t dt,
/// with the rotation at the middle of the step, which is exact to second order in turns.
///
/// Rotation comes from outside (ground truth, IMU, TF) when it is given, else from the yaw rate.
class VelocityIntegrator {
 public:
  struct State {
    double time = 0.0;  ///< s
    Eigen::Isometry3d T_odom_from_base = Eigen::Isometry3d::Identity();
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< x y z roll pitch yaw
    double distance = 0.0;                                                         ///< m, length of the path
  };

  /// Restarts at the given pose; the next velocity only sets the clock.
  void reset(const Eigen::Isometry3d& T_odom_from_base = Eigen::Isometry3d::Identity());

  /// Adds a velocity. Between two calls the velocity is taken as linear.
  /// @param R_odom_from_base  orientation at its time from another source; none: the integral of its angular
  /// velocity
  /// @return false, and no change, when its time does not lie after the previous one, or when
  ///         anything is not finite.
  bool add(const StampedTwist& twist,
           const std::optional<Eigen::Quaterniond>& R_odom_from_base = std::nullopt);

  bool started() const noexcept { return started_; }
  const State& state() const noexcept { return state_; }

 private:
  State state_;
  StampedTwist previous_;
  bool started_ = false;
};

/// Acceleration of the vehicle from its recent velocity estimates: the slope of a straight line
/// through those of the last `window` seconds. Brings unsynchronised scans to one time. Only
/// velocities with an observed forward component belong in it.
class AccelerationTracker {
 public:
  explicit AccelerationTracker(double window = 0.5) : window_(window) {}
  /// Adds a velocity (m/s, base frame) at `time` (s). Going back in time resets it.
  void add(double time, const Eigen::Vector3d& linear);
  /// m/s^2, base frame, near `time`; zero until three velocities cover a quarter of the window, when
  /// the newest is older than the window, or when the slope is beyond what tyres can do (kMaxAcceleration).
  Eigen::Vector3d acceleration(double time) const;
  void reset() { history_.clear(); }
  static constexpr double kMaxAcceleration = 12.0;  ///< m/s^2

 private:
  struct Sample {
    double time;
    Eigen::Vector3d linear;
  };
  double window_;
  std::deque<Sample> history_;
};

}  // namespace radar_dot
