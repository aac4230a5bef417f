// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>

#include <memory>
#include <optional>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/labelled_scans.h"
#include "nodelets/inputs/object_regions.h"
#include "nodelets/messages/object_messages.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/objects/object_tracker.h"

namespace radar_dot {

/// Objects that move independently, with position and velocity, followed over the scans of all radars.
///
/// Takes the returns as EgoVelocity has labelled them, each scan at its own stamp, and the pose of the
/// vehicle from the odometry. With use_mask the regions of dynamic/mask are a further sensor, at the stamp of
/// the mask.
class MovingObjectsNodelet : public ConfiguredNodelet<MovingObjectsConfig> {
 private:
  void setUp() override;
  void listenToMasks();
  bool hasAudience() const override;
  void apply(const MovingObjectsConfig& config) override;
  void tick() override {
    guard(*static_input_, [this] {
      processQueue();
      processMasks();
    });
  }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onCloud(const sensor_msgs::PointCloud2& cloud, ReturnLabel label);
  void onOdometry(const nav_msgs::Odometry& odometry);
  void processQueue();
  void processMasks();
  /// @return false, with `reason`, where the scan is of no use
  bool useScan(const LabelledScan& scan, std::string& reason);
  bool useMask(const MaskMessages& messages, std::string& reason);
  /// Pose of the vehicle in the frame of the odometry, carried on by the twists beyond the latest.
  std::optional<Eigen::Isometry3d> poseAt(const ros::Time& time, std::string& missing);
  void publish(const ros::Time& stamp);
  /// @param pose  of the vehicle at `stamp`
  MovingObjects objectsAt(const ros::Time& stamp, const Eigen::Isometry3d& pose, ObjectFrame frame) const;
  void deleteMarkers();
  bool inBaseFrame() const noexcept { return config_.frame == ObjectFrame::kBase; }
  void drop(const std::string& reason);

  std::unique_ptr<EgoMotion> motion_;
  LabelledScans scans_;
  MaskMatcher masks_;
  sensor_msgs::CameraInfoConstPtr camera_;
  PoseBuffer poses_;
  std::string odom_frame_;  // of the poses
  ObjectTracker tracker_;
  ros::Time newest_;     // stamp of the newest scan that was used
  ros::Time published_;  // stamp of the latest message
  ObjectMarkers markers_;

  InputMonitor *static_input_ = nullptr, *dynamic_input_ = nullptr, *twist_input_ = nullptr,
               *odometry_input_ = nullptr, *mask_input_ = nullptr, *camera_input_ = nullptr;
  ros::Publisher objects_publisher_, markers_publisher_, covariances_publisher_, obstacles_publisher_;

  // For the diagnostic.
  double computation_time_ = 0.0, latency_ = 0.0;
  std::size_t objects_ = 0, dropped_ = 0;
  std::size_t scans_since_report_ = 0, masks_since_report_ = 0, dropped_since_report_ = 0,
              incomplete_since_report_ = 0;
  std::string drop_reason_;
  ros::WallTime first_scan_;
};

}  // namespace radar_dot
