// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <functional>
#include <string>

#include "nodelets/common/input_monitor.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/common/twist_history.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// The latest dynamic mask, for the returns that lie in it: the image's half of the loop between mask and
/// velocity. Subscribes to dynamic/mask and camera_info while it is enabled.
class MaskInput {
 public:
  /// @param warn  for masks that cannot be used
  MaskInput(ros::NodeHandle& handle, Extrinsics& extrinsics, std::function<void(const std::string&)> warn);

  /// use_mask, mask_max_age and the footprint. Does not throw.
  void configure(const EgoVelocityConfig& config);
  /// A velocity of the vehicle, which brings returns to the time of the mask.
  void add(const StampedTwist& velocity);
  void forget();

  /// Sets known_dynamic of a scan where there is a mask that tells.
  void mark(RadarScan& scan);

  InputMonitor& maskMonitor() noexcept { return mask_monitor_; }
  InputMonitor& cameraMonitor() noexcept { return camera_monitor_; }
  /// Adds figures, and a warning where no scan had a mask; starts the next interval.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  /// Runs `body`; whatever it throws becomes a refusal.
  void guard(InputMonitor& input, const std::function<void()>& body);
  void onMask(const sensor_msgs::ImageConstPtr& mask);
  void subscribe();
  /// Returns why there is no mask that tells; empty: there is. @throws std::invalid_argument for a mask that
  /// does not fit its camera
  std::string markByLatest(RadarScan& scan);

  ros::NodeHandle handle_;
  Extrinsics& extrinsics_;
  std::function<void(const std::string&)> warn_;
  bool enabled_ = false;
  double max_age_ = 0.0;
  MaskFootprint footprint_;
  InputMonitor mask_monitor_, camera_monitor_;
  ros::Subscriber mask_subscriber_, camera_subscriber_;
  sensor_msgs::ImageConstPtr mask_;
  sensor_msgs::CameraInfoConstPtr camera_;
  TwistHistory velocities_;
  std::size_t marked_ = 0, scans_ = 0, unused_ = 0;  // since the last report
  std::string unused_reason_;
};

}  // namespace radar_dot
