// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "nodelets/common/image_subscriber.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/stamp_cache.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/vision/depth_estimator.h"

namespace radar_dot {

/// Metric depth for every image, from the ground and radar returns, from a lidar, or from a depth topic.
///
/// Clouds are brought to the time of the image by the vehicle's own motion, where ego/twist tells it.
class DepthNodelet : public ImageSubscriber {
 private:
  struct RadarTopic {
    std::string topic;
    InputMonitor* input;
  };

  void onInit() override;
  /// The topics of a parameter, as inputs; those that cannot be subscribed are reported and left out.
  std::vector<RadarTopic> addRadars(const std::vector<std::string>& topics);
  void apply(const DepthConfig& config);
  void connectInputs();
  void disconnectInputs();
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onImage(LazyImage picture);
  void onDepth(const sensor_msgs::ImageConstPtr& message);
  /// @param relative_std  of the depth; empty without subscribers
  void publish(const std_msgs::Header& header, const cv::Mat& depth, const cv::Mat& relative_std);
  bool wantsUncertainty() const { return uncertainty_publisher_.getNumSubscribers() > 0; }

  DepthConfig config_;             // in force
  std::string connected_backend_;  // whose inputs are subscribed; empty: none can be told
  ros::WallTime last_depth_;
  std::unique_ptr<DepthEstimator> estimator_;  // none: the depth is external, or no backend could be made

  std::unique_ptr<Extrinsics> extrinsics_;
  std::unique_ptr<EgoMotion> motion_;
  std::unique_ptr<RecentClouds> radar_clouds_, lidar_clouds_;
  sensor_msgs::CameraInfoConstPtr camera_;

  InputMonitor *image_ = nullptr, *camera_input_ = nullptr, *twist_input_ = nullptr, *lidar_input_ = nullptr,
               *depth_input_ = nullptr;
  std::vector<RadarTopic> radars_;
  std::vector<RadarTopic> network_radars_;  // for networks that were trained with these alone
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber image_subscriber_;
  ros::Publisher publisher_, uncertainty_publisher_;

  double computation_time_ = 0.0, known_share_ = 0.0;  // of the latest depth
  std::size_t computed_ = 0, points_ = 0;
};

}  // namespace radar_dot
