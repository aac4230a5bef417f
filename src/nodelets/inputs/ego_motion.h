// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/rotation_source.h"
#include "nodelets/inputs/twist_history.h"

namespace radar_dot {

/// The vehicle's motion between two times, from ego/twist and a source of rotation.
class EgoMotion {
 public:
  /// @param changed  called when a twist or a rotation arrived
  /// @param warn     for what is wrong with the source of rotation
  /// @param needs_yaw_rate  without a source of rotation, twists that do not observe the yaw rate are left
  /// out
  EgoMotion(Extrinsics& extrinsics, std::function<void()> changed,
            std::function<void(const std::string&)> warn, bool needs_yaw_rate = false)
      : extrinsics_(extrinsics),
        changed_(std::move(changed)),
        warn_(std::move(warn)),
        needs_yaw_rate_(needs_yaw_rate) {}

  /// A twist that has passed its input. One that does not observe vx is left out: its neighbours stand in.
  /// @throws std::invalid_argument saying what is wrong with it.
  void add(const geometry_msgs::TwistWithCovarianceStamped& twist);

  /// @throws InvalidParameter as makeRotationSource; the yaw rate of the twists is used then.
  void setUpRotation(const RotationParams& params, ros::NodeHandle& handle);

  struct Answer {
    std::optional<Eigen::Isometry3d> T_begin_from_end;  ///< of the base frame; none: see `missing`
    std::string missing;
    bool without_rotation = false;  ///< the twists' own rates stand in for the source of rotation
  };
  /// `end` may be the earlier one.
  /// @param max_hold  s that the latest twist is taken to hold
  /// @param within_timeout   true: without a rotation at both times there is no answer yet; false: the
  /// twists' own
  Answer between(const ros::Time& begin, const ros::Time& end, double max_hold, bool within_timeout);
  /// Velocity of the vehicle at `time`, from the twists alone; none: see `missing`.
  std::optional<StampedVelocity> velocityAt(const ros::Time& time, double max_hold,
                                            std::string& missing) const;
  /// Of the latest twist that was not left out, as in its message; zero before the first.
  const geometry_msgs::TwistWithCovariance::_covariance_type& latestCovariance() const { return covariance_; }
  bool hasRotation() const { return rotation_ != nullptr; }
  void forget();
  /// "odometry on '/rotation/odom'", or "yaw rate of the radars".
  std::string rotationText() const;

 private:
  /// With what the latest twists do not observe.
  std::string explained(const std::string& missing) const;

  Extrinsics& extrinsics_;
  std::function<void()> changed_;
  std::function<void(const std::string&)> warn_;
  TwistHistory twists_;
  std::unique_ptr<RotationSource> rotation_;  // none: the twists' own
  bool needs_yaw_rate_;
  geometry_msgs::TwistWithCovariance::_covariance_type covariance_{};
  std::string unobserved_;  // what the latest twist that was left out does not observe
};

}  // namespace radar_dot
