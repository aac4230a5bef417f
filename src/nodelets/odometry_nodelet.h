// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "nodelets/common/log_throttle.h"
#include "nodelets/common/monitors.h"
#include "nodelets/common/reconfigure_server.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/moment.h"
#include "nodelets/inputs/rotation_source.h"
#include "nodelets/inputs/stamp_guard.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/odometry.h"

namespace radar_dot {

/// Odometry and path from the vehicle's velocity and a source of rotation.
///
/// A twist waits for a rotation at its stamp, in order, until rotation_timeout; then it is
/// integrated with its own yaw rate. All callbacks run one after the other.
class OdometryNodelet : public nodelet::Nodelet {
 private:
  struct PendingTwist {
    geometry_msgs::TwistWithCovarianceStampedConstPtr message;
    Moment arrival;
  };

  void onInit() override;
  void setUpRotationSource();
  void setUpDiagnostics();
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);
  void reportRotation(diagnostic_updater::DiagnosticStatusWrapper& status);

  void takeTwist(const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist);
  void onTwist(const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist);
  /// Why the twist cannot be used; empty when it can.
  std::string defectOf(const geometry_msgs::TwistWithCovarianceStamped& twist) const;
  void processQueue();
  void integrate(const geometry_msgs::TwistWithCovarianceStamped& twist,
                 const std::optional<StampedPose>& pose);
  bool start(const std::optional<StampedPose>& pose);
  /// The twist onWheels(); warns of what it does not observe.
  StampedTwist usableTwist(const geometry_msgs::TwistWithCovarianceStamped& message, bool rotation_known);
  /// Rotation of the base in the odometry's frame, from the source's.
  std::optional<Eigen::Quaterniond> rotationFrom(const std::optional<StampedPose>& pose);
  /// Once per frame of the source, when asked for.
  void publishSourceTf();
  void bridgeGap(double gap, double speed);
  /// Forgets the past when the clock went back.
  void checkClock();
  void clearHistory();
  void warn(const std::string& text);

  void publish(const geometry_msgs::TwistWithCovarianceStamped& twist);
  void extendPath(const geometry_msgs::PoseStamped& pose);

  OdometryConfig config_;            // in force
  bool start_at_source_ = false;     // as configured, where the source has a position
  std::string tied_frame_;           // frame of the source that was published to coincide with odom_frame
  std::string configuration_error_;  // of the rotation source

  std::unique_ptr<Extrinsics> extrinsics_;
  std::unique_ptr<RotationSource> rotation_source_;  // none: the twist's own yaw rate
  std::deque<PendingTwist> pending_;
  ClockWatch clock_;
  StampGuard twist_stamps_;

  VelocityIntegrator integrator_;
  bool started_ = false;
  std::optional<Eigen::Quaterniond> R_odom_from_source_;
  // What the integrator had found before it was restarted at a gap.
  double distance_before_gap_ = 0.0;
  Eigen::Matrix<double, 6, 6> covariance_before_gap_ = Eigen::Matrix<double, 6, 6>::Zero();
  nav_msgs::Path path_;

  std::unique_ptr<StreamMonitor> twist_monitor_;
  std::string unobserved_;            // components of the latest twist that its returns do not determine
  std::size_t without_rotation_ = 0;  // twists since the last report integrated without the source
  std::size_t gaps_ = 0, refused_ = 0;

  ros::Publisher odometry_publisher_, path_publisher_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> static_broadcaster_;
  ros::Subscriber twist_subscriber_;
  LogThrottle throttle_;
  std::unique_ptr<ReconfigureServer<OdometryConfig>> server_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_, pending_timer_;
};

}  // namespace radar_dot
