// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/PointCloud2.h>

#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/stamp_cache.h"
#include "nodelets/inputs/waiting_queue.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {

/// Images, depths and clouds without what moves, for SLAM and maps: one output for every input, with its
/// header, whether or not there is a mask.
///
/// An input waits until the masks have reached its stamp, and is used with the nearest one. Without one that
/// is near enough all is kept.
class StaticWorldNodelet : public ConfiguredNodelet<StaticWorldConfig> {
 private:
  /// An input that waits for its mask, and what is done then.
  struct Task {
    ros::Time stamp;
    std::function<void()> publish;
  };
  using Queue = WaitingQueue<Task>;
  /// Of a mask, which serves several outputs.
  struct Distance {
    sensor_msgs::ImageConstPtr mask;
    cv::Mat pixels;  // as of distanceToMoving()
  };

  void setUp() override;
  void listenToInputs();
  bool hasAudience() const override { return imagesWanted() || depthsWanted() || pointsWanted(); }
  bool imagesWanted() const {
    return mask_publisher_.getNumSubscribers() + image_publisher_.getNumSubscribers() > 0;
  }
  bool depthsWanted() const { return depth_publisher_.getNumSubscribers() > 0; }
  bool pointsWanted() const { return points_publisher_.getNumSubscribers() > 0; }
  void apply(const StaticWorldConfig& config) override;
  void tick() override { processQueues(); }
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void add(Queue& queue, const ros::Time& stamp, std::function<void()> publish);
  void processQueues();
  void processQueue(Queue& queue, InputMonitor& input);
  void publishImage(LazyImage& picture);
  void publishDepth(const sensor_msgs::Image& depth);
  void publishPoints(const sensor_msgs::PointCloud2ConstPtr& cloud);
  sensor_msgs::PointCloud2ConstPtr withoutMoving(const sensor_msgs::PointCloud2ConstPtr& cloud,
                                                 const sensor_msgs::ImageConstPtr& mask,
                                                 const CameraIntrinsics& camera);

  /// The mask that holds at a time, for a grid of the image's shape; null, counted and warned of: there is
  /// none.
  sensor_msgs::ImageConstPtr maskAt(const ros::Time& stamp, const cv::Size& size);
  /// The same for an image or a depth, which must be in the frame of the mask: else warned of.
  sensor_msgs::ImageConstPtr maskOf(const std_msgs::Header& header, const cv::Size& size);
  /// Which pixels are kept there: 255, else 0. @param mask  null: all
  cv::Mat keepOf(const sensor_msgs::ImageConstPtr& mask, const ros::Time& stamp, const cv::Size& size);
  void notePublished(const ros::Time& stamp);

  std::unique_ptr<EgoMotion> motion_;
  sensor_msgs::CameraInfoConstPtr camera_;
  StampCache<sensor_msgs::Image> masks_;
  std::deque<Distance> distances_;  // of the latest masks that were used
  Queue images_, depths_, clouds_;

  InputMonitor *image_input_ = nullptr, *mask_input_ = nullptr, *depth_input_ = nullptr,
               *points_input_ = nullptr, *camera_input_ = nullptr;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Publisher mask_publisher_, image_publisher_;
  ros::Publisher depth_publisher_, points_publisher_;

  // For the diagnostic.
  double latency_ = 0.0, apart_since_report_ = 0.0;  // s
  std::size_t published_ = 0, without_mask_ = 0;
  std::size_t published_since_report_ = 0, by_another_since_report_ = 0, without_mask_since_report_ = 0,
              without_motion_since_report_ = 0, of_another_frame_since_report_ = 0;
  std::string lack_, frames_;
};

}  // namespace radar_dot
