// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/moment.h"
#include "nodelets/inputs/rotation_source.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/odometry.h"

namespace radar_dot {

/// Odometry and path from the vehicle's velocity and a source of rotation.
///
/// A twist waits for a rotation at its stamp, in order, until rotation_timeout; then it is
/// integrated with its own yaw rate.
class OdometryNodelet : public ConfiguredNodelet<OdometryConfig> {
 private:
  struct PendingTwist {
    geometry_msgs::TwistWithCovarianceStampedConstPtr message;
    Moment arrival;
  };

  void setUp() override;
  void setUpRotationSource();
  void started() override {
    if (rotation_source_) rotation_source_->start();
  }
  void tick() override {
    guard(*twist_input_, [this] { processQueue(); });
  }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  /// How the twists and the source of rotation contradict each other; empty: they do not.
  std::string contradictionOfSource() const;
  void reportRotation(diagnostic_updater::DiagnosticStatusWrapper& status);
  /// Of a node that publishes the transform to the base frame as well; empty: there is none.
  std::string tfConflict() const;
  void onTf(const ros::MessageEvent<const tf2_msgs::TFMessage>& event);

  void onTwist(const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist);
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

  void publish(const geometry_msgs::TwistWithCovarianceStamped& twist);
  void extendPath(const geometry_msgs::PoseStamped& pose);

  std::string odom_frame_;
  bool start_at_source_ = false;  // as configured, where the source has a position
  std::string tied_frame_;        // frame of the source that was published to coincide with odom_frame

  std::unique_ptr<RotationSource> rotation_source_;  // none: the twist's own yaw rate
  std::deque<PendingTwist> pending_;

  VelocityIntegrator integrator_;
  bool started_ = false;
  std::optional<Eigen::Quaterniond> R_odom_from_source_;
  // What the integrator had found before it was restarted at a gap.
  double distance_before_gap_ = 0.0;
  Eigen::Matrix<double, 6, 6> covariance_before_gap_ = Eigen::Matrix<double, 6, 6>::Zero();
  nav_msgs::Path path_;

  InputMonitor* twist_input_ = nullptr;
  std::vector<ros::Subscriber> tf_subscribers_;
  std::string tf_rival_;  // node that published the transform to the base frame
  ros::WallTime tf_rival_holds_until_;
  std::string unobserved_;            // components of the latest twist that its returns do not determine
  std::size_t without_rotation_ = 0;  // twists since the last report integrated without the source
  std::size_t gaps_ = 0;

  ros::Publisher odometry_publisher_, path_publisher_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> static_broadcaster_;
};

}  // namespace radar_dot
