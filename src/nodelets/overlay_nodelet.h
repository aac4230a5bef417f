// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/moment.h"
#include "nodelets/inputs/stamp_cache.h"
#include "nodelets/inputs/waiting_queue.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/vision/drawing.h"

namespace radar_dot {

/// Visualisation on demand: the mask over the image, and the paper's six panels.
///
/// Listens to its inputs only while a picture has subscribers. A mask waits for what belongs to its stamp;
/// what has not come in time is missing in the picture.
class OverlayNodelet : public ConfiguredNodelet<OverlayConfig> {
 private:
  /// What belongs to one stamp.
  struct Parts {
    std::shared_ptr<LazyImage> image;
    sensor_msgs::ImageConstPtr valid, depth, expected_flow;
    FlowConstPtr flow;
  };
  /// A picture found again by its stamp.
  struct KeptImage {
    ros::Time stamp;
    std::shared_ptr<LazyImage> picture;
  };

  void setUp() override;
  void listenToInputs();
  bool hasAudience() const override { return maskWanted() || panelsWanted(); }
  bool maskWanted() const { return mask_publisher_.getNumSubscribers() > 0; }
  bool panelsWanted() const { return panels_publisher_.getNumSubscribers() > 0; }
  bool listensForPanels() const { return !depth_input_->topic().empty(); }
  void tick() override {
    guard(*mask_input_, [this] { processQueue(); });
  }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void keepImage(LazyImage picture);
  void onMask(const sensor_msgs::ImageConstPtr& mask);
  void processQueue();
  void dropThrough(const ros::Time& stamp);
  Parts partsAt(const ros::Time& stamp) const;
  std::string missingOf(const Parts& parts) const;
  void draw(const sensor_msgs::ImageConstPtr& message, const Parts& parts);
  std::vector<RadarPixel> radarPixels(const std_msgs::Header& header);

  std::unique_ptr<EgoMotion> motion_;
  std::unique_ptr<RecentClouds> static_returns_, dynamic_returns_;
  std::deque<KeptImage> images_;
  StampCache<sensor_msgs::Image> valids_, depths_, expected_flows_;
  StampCache<Flow> flows_;
  sensor_msgs::CameraInfoConstPtr camera_;
  WaitingQueue<sensor_msgs::ImageConstPtr> waiting_;

  InputMonitor *image_ = nullptr, *mask_input_ = nullptr, *valid_input_ = nullptr, *depth_input_ = nullptr,
               *flow_input_ = nullptr, *expected_input_ = nullptr;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Publisher mask_publisher_, panels_publisher_;

  ros::WallTime last_drawn_;
  double drawing_time_ = 0.0;  // s, of the latest pictures
  std::size_t drawn_ = 0, incomplete_since_report_ = 0;
  std::string missing_;
};

}  // namespace radar_dot
