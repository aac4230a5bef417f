// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>

#include <deque>
#include <memory>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/mask_history.h"
#include "nodelets/inputs/stamp_cache.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// What moves independently in the images: the paper's mask, from flow, depth and the vehicle's own motion.
///
/// A flow waits for the depth at the stamps of its two images, and for the rotation between them; messages
/// belong together where their stamps are equal. The mask lies on the first image of the flow and carries its
/// stamp: the earlier image where flow runs forward (as in the paper), the later one where it runs backward.
class DynamicSegmentationNodelet : public ConfiguredNodelet<DynamicSegmentationConfig> {
 private:
  struct WaitingFlow {
    FlowConstPtr message;
    ros::WallTime arrival;
    sensor_msgs::ImageConstPtr depth, next_depth;  // as soon as they are there
  };
  /// Everything that goes with one flow.
  struct Inputs : PairInputs {
    Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
    bool without_rotation = false;  // of the source; the twists' own instead
  };

  void setUp() override;
  void setUpInputs();
  void setUpOutputs();
  bool hasAudience() const override;
  void apply(const DynamicSegmentationConfig& config) override;
  void tick() override { processQueue(); }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onFlow(const FlowConstPtr& flow);
  void processQueue();
  enum class Availability { kComplete, kPending, kImpossible };
  /// What goes with a flow; what is missing is named in `missing`.
  Availability gather(WaitingFlow& waiting, Inputs& inputs, std::string& missing);
  /// The same for the two depths.
  Availability gatherDepths(WaitingFlow& waiting, std::string& missing);
  /// @throws std::invalid_argument where grids do not go together
  void placeOnGrid(Inputs& inputs) const;
  void addRadarPoints(Inputs& inputs);
  /// Motion, its covariance, and where depth shows the ground, both depths, by the image.
  void refine(Inputs& inputs);
  const MotionResult& maskOf(Inputs& inputs);
  void segment(Inputs& inputs);
  void publish(const Inputs& inputs, const MotionResult& result);
  void drop(const std::string& reason);

  MotionSegmenter segmenter_;
  std::unique_ptr<EgoMotion> motion_;
  std::unique_ptr<RecentClouds> static_returns_, dynamic_returns_;
  StampCache<sensor_msgs::Image> depths_, depth_stds_;
  MaskHistory history_;
  sensor_msgs::CameraInfoConstPtr camera_;
  std::deque<WaitingFlow> waiting_;

  InputMonitor *flow_input_ = nullptr, *depth_input_ = nullptr, *camera_input_ = nullptr,
               *twist_input_ = nullptr, *backward_input_ = nullptr, *depth_std_input_ = nullptr;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Publisher mask_publisher_, valid_publisher_;
  ros::Publisher score_publisher_, expected_flow_publisher_, residual_publisher_, refined_publisher_;

  // Of the latest mask.
  double computation_time_ = 0.0, latency_ = 0.0, valid_share_ = 0.0, mask_share_ = 0.0;
  double median_ = 0.0, mad_ = 0.0, threshold_ = 0.0;
  std::size_t masks_ = 0, dropped_ = 0;
  std::size_t masks_since_report_ = 0, dropped_since_report_ = 0, without_rotation_since_report_ = 0,
              without_next_depth_since_report_ = 0, without_past_since_report_ = 0,
              without_depth_std_since_report_ = 0;
  std::string drop_reason_;
};

}  // namespace radar_dot
