// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>

#include <memory>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/waiting_pairs.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/yaw_rate_comparison.h"
#include "radar_dot/vision/mask_pipeline.h"

namespace radar_dot {

/// What moves independently in the images: the paper's mask, from flow, depth and the vehicle's own motion.
///
/// A flow waits for the depth at the stamps of its two images, and for the rotation between them; messages
/// belong together where their stamps are equal. The mask lies on the first image of the flow and carries its
/// stamp: the earlier image where flow runs forward (as in the paper), the later one where it runs backward.
class DynamicSegmentationNodelet : public ConfiguredNodelet<DynamicSegmentationConfig> {
 private:
  /// Everything that goes with one flow; the messages own the pixels.
  struct Inputs {
    WaitingPairs::Pair messages;
    MaskPair pair;
    bool without_rotation = false;  // of the source; the twists' own instead
  };

  void setUp() override;
  void setUpInputs();
  void setUpOutputs();
  bool hasAudience() const override;
  bool wantsMotionDepth() const;
  void apply(const DynamicSegmentationConfig& config) override;
  void tick() override {
    guard(*flow_input_, [this] { processQueue(); });
  }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onFlow(const FlowConstPtr& flow);
  void processQueue();
  /// Where the camera was, and how it moved over a pair. @return what is missing
  std::string findMotion(const WaitingPairs::Pair& messages, double waited, Inputs& inputs);
  /// @throws std::invalid_argument where grids do not go together
  void placeOnGrid(Inputs& inputs) const;
  void addRadarPoints(Inputs& inputs);
  void segment(const Inputs& inputs);
  void publish(const Inputs& inputs, const MaskOutcome& outcome);
  void compareYawRates(const Inputs& inputs, const StampedTwist& refined, double weight);
  void drop(const std::string& reason);

  MaskPipeline pipeline_;
  std::unique_ptr<EgoMotion> motion_;
  std::unique_ptr<RecentClouds> static_returns_, dynamic_returns_;
  WaitingPairs waiting_;
  YawRateComparison yaw_rates_;  // of the twists, with the image
  sensor_msgs::CameraInfoConstPtr camera_;

  InputMonitor *flow_input_ = nullptr, *depth_input_ = nullptr, *camera_input_ = nullptr,
               *twist_input_ = nullptr, *backward_input_ = nullptr, *depth_std_input_ = nullptr;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Publisher mask_publisher_, valid_publisher_;
  ros::Publisher score_publisher_, expected_flow_publisher_, residual_publisher_, refined_publisher_,
      motion_depth_publisher_, motion_depth_std_publisher_;

  // Of the latest mask.
  double computation_time_ = 0.0, latency_ = 0.0, valid_share_ = 0.0, mask_share_ = 0.0;
  double median_ = 0.0, mad_ = 0.0, threshold_ = 0.0;
  double waiting_time_ = 0.0, refinement_time_ = 0.0;  // s
  std::size_t masks_ = 0, dropped_ = 0;
  std::size_t masks_since_report_ = 0, dropped_since_report_ = 0, without_rotation_since_report_ = 0,
              without_next_depth_since_report_ = 0, without_past_since_report_ = 0,
              without_depth_std_since_report_ = 0;
  std::string drop_reason_;
};

}  // namespace radar_dot
