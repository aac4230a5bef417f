// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "nodelets/common/monitors.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/common/twist_history.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// The latest dynamic mask, for the returns that lie in it: the image's half of the loop between mask and
/// velocity.
class MaskInput {
 public:
  /// @param masks, cameras  the inputs that setMask() and setCamera() are called for
  MaskInput(Extrinsics& extrinsics, InputMonitor& masks, InputMonitor& cameras)
      : extrinsics_(extrinsics), masks_(masks), cameras_(cameras) {}

  /// use_mask, mask_max_age and the footprint. Does not throw.
  void configure(const EgoVelocityConfig& config);
  /// @throws std::invalid_argument for what is no mask, or no camera
  void setMask(const sensor_msgs::ImageConstPtr& mask);
  void setCamera(const sensor_msgs::CameraInfoConstPtr& camera);
  /// A velocity of the vehicle, which brings returns to the time of the mask.
  void add(const StampedTwist& velocity);
  void forget();

  /// Sets known_dynamic of a scan where there is a mask that tells.
  void mark(RadarScan& scan);

  /// Adds figures, and a warning where no scan had a mask; starts the next interval.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  /// Returns why there is no mask that tells; empty: there is. @throws std::invalid_argument for a mask that
  /// does not fit its camera
  std::string markByLatest(RadarScan& scan);

  Extrinsics& extrinsics_;
  InputMonitor &masks_, &cameras_;
  bool enabled_ = false;
  double max_age_ = 0.0;
  MaskFootprint footprint_;
  sensor_msgs::ImageConstPtr mask_;
  sensor_msgs::CameraInfoConstPtr camera_;
  TwistHistory velocities_;
  std::size_t marked_ = 0, scans_ = 0, unused_ = 0;  // since the last report
  std::string unused_reason_;
};

}  // namespace radar_dot
