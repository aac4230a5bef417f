// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/ros.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "nodelets/inputs/extrinsics.h"
#include "radar_dot/common/angular_velocity.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/speed_comparison.h"
#include "radar_dot/radar/yaw_rate_comparison.h"

namespace radar_dot {

/// Where the rotation of the vehicle comes from, besides the radars.
class RotationSource {
 public:
  /// Told about the source by the one who uses it.
  struct Callbacks {
    std::function<void()> arrival;    ///< a message came, before it is looked at
    std::function<void()> sample;     ///< a new sample is there
    std::function<void()> restarted;  ///< rotations from here on do not compare with those before
    std::function<void(const std::string&)> warn;
  };

  virtual ~RotationSource() = default;

  /// Listens from now on; until then no callback is called, so that their owner can hold the source first.
  virtual void start() {}

  /// Pose of the base frame in the source's own frame; none: not known, or not yet.
  virtual std::optional<StampedPose> at(const ros::Time& stamp) = 0;
  /// Angular velocity of the base frame at `stamp`, or shortly before where nothing later has come; none: not
  /// known. By default from the difference of two rotations.
  virtual std::optional<AngularVelocity> rateAt(const ros::Time& stamp);
  /// Velocity of the vehicle, at a time where at() knows the pose: tells acceleration from gravity.
  virtual void addVelocity(const StampedTwist& twist) { static_cast<void>(twist); }
  /// Time of the latest sample, s; none: nothing received.
  virtual std::optional<double> latest() const = 0;
  virtual void reset() = 0;
  /// True where rotations before and after a silence compare with each other.
  virtual bool isAbsolute() const = 0;
  /// True where samples have a position.
  virtual bool hasPosition() const = 0;
  /// Frame that samples with a position are given in; empty: not known (yet).
  virtual std::string frame() const = 0;
  /// One line for logs: what the source listens to.
  virtual std::string describe() const = 0;

  // What the radars alone say, in the order of time, is compared with the source.
  /// @param time  s   @param yaw_rate  rad/s   @param variance  (rad/s)^2
  void compareRate(double time, double yaw_rate, double variance);
  /// @param forward  m/s, at the origin of the base frame
  void compareSpeed(double time, double forward);
  /// The same with what a twist observes.
  void compare(const StampedTwist& twist);
  /// Forgets contradictions for which there are no readings any more, up to `time`.
  void expireComparisons(double time);
  bool contradictsSpeed() const { return speeds_.verdict() != SpeedComparison::Verdict::kAgree; }
  /// What has contradicted for seconds, and the likely cause; empty: nothing.
  /// @param radars, rates  what is compared, and its range rates, for the text
  std::string contradiction(const std::string& radars, const std::string& rates) const;

 private:
  /// Of the base, over a moment that ends at `stamp` or shortly before; none: not known.
  std::optional<StampedTwist> motionAt(const ros::Time& stamp);

  YawRateComparison rates_;
  SpeedComparison speeds_;
};

/// The pose of a message. @throws std::invalid_argument where it has no unit quaternion or is not finite.
StampedPose poseOf(const nav_msgs::Odometry& odometry);

/// The source that the parameters name, not started; none: the twist's own yaw rate.
/// @throws InvalidParameter for a tf without a frame of its own
std::unique_ptr<RotationSource> makeRotationSource(const RotationParams& params, ros::NodeHandle& handle,
                                                   Extrinsics& extrinsics,
                                                   RotationSource::Callbacks callbacks);

}  // namespace radar_dot
