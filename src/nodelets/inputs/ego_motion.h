// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <ros/ros.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/rotation_source.h"
#include "radar_dot/common/twist_history.h"

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

  /// TwistHistory::between, with the source of rotation.
  IntervalMotion between(const ros::Time& begin, const ros::Time& end, double max_hold, bool may_wait);
  /// Velocity of the vehicle at `time`, from the twists alone; none: see `missing`.
  std::optional<StampedTwist> velocityAt(const ros::Time& time, double max_hold, std::string& missing) const;
  /// Of the latest twist that was not left out; zero before the first.
  Eigen::Matrix<double, 6, 6> latestCovariance() const {
    return twists_.latest() != nullptr ? twists_.latest()->covariance : StampedTwist().covariance;
  }
  bool hasRotation() const { return rotation_ != nullptr; }
  void forget();
  /// How the twists and the source of rotation contradict each other, and why; empty: they do not.
  std::string contradiction() const;
  /// "odometry on '/rotation/odom'", or "yaw rate of the twists".
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
  std::string unobserved_;  // what the latest twist that was left out does not observe
};

}  // namespace radar_dot
