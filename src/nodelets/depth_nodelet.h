// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/vision/depth_estimator.h"

namespace radar_dot {

/// Metric depth for every image, from the ground and radar returns, from a lidar, or from a depth topic.
///
/// Clouds are brought to the time of the image by the vehicle's own motion, where ego/twist tells it.
class DepthNodelet : public ConfiguredNodelet<DepthConfig> {
 private:
  void setUp() override;
  /// @param trained_only  the topics are for networks that were trained with these alone
  void listenToRadars(const std::vector<std::string>& topics, const char* parameter, bool trained_only);
  bool hasAudience() const override { return publisher_.getNumSubscribers() > 0 || wantsUncertainty(); }
  void apply(const DepthConfig& config) override;
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onImage(LazyImage picture);
  void onDepth(const sensor_msgs::ImageConstPtr& message);
  /// @param relative_std  of the depth; empty without subscribers
  void publish(const std_msgs::Header& header, const cv::Mat& depth, const cv::Mat& relative_std);
  bool wantsUncertainty() const { return uncertainty_publisher_.getNumSubscribers() > 0; }

  /// Nothing but images where there is no estimator: they are refused with the reason.
  DepthNeeds needs() const { return estimator_ ? estimator_->needs() : DepthNeeds{}; }

  std::unique_ptr<DepthEstimator> estimator_;  // none: the depth is external, or no backend could be made

  std::unique_ptr<EgoMotion> motion_;
  std::unique_ptr<RecentClouds> radar_clouds_, lidar_clouds_;
  sensor_msgs::CameraInfoConstPtr camera_;
  std::optional<LazyImage> early_;  // came before any camera_info

  InputMonitor *camera_input_ = nullptr, *lidar_input_ = nullptr;
  ros::Publisher publisher_, uncertainty_publisher_;

  double computation_time_ = 0.0, known_share_ = 0.0;  // of the latest depth
  std::size_t computed_ = 0, points_ = 0;
};

}  // namespace radar_dot
