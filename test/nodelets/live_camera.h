// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <functional>
#include <mutex>

#include "live_graph.h"

namespace radar_dot::test {

/// Publishes the images of a VisionWorld with a moving texture, a radar return, a lidar point, and depth, at
/// 10 Hz from a thread.
class LiveCamera {
 public:
  static constexpr double kShift = 4.0;         ///< px to the right per image
  static constexpr float kReturnAhead = 12.0F;  ///< m, base frame, 0.1 s before the image

  /// Messages of one image; faults change them.
  struct Frame {
    sensor_msgs::Image image;
    sensor_msgs::CompressedImage compressed;
    sensor_msgs::Image depth;
    sensor_msgs::Image mask;
    geometry_msgs::TwistWithCovarianceStamped twist;
  };
  using Fault = std::function<void(Frame&)>;

  explicit LiveCamera(ros::NodeHandle& handle);
  void set(const Fault& fault);

 private:
  void publish();

  ros::Publisher image_, compressed_, depth_, camera_, twist_, radar_, lidar_, mask_, valid_, expected_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::mutex mutex_;
  Fault fault_;
  int count_ = 0;  // of images
  Ticker ticker_;
};

}  // namespace radar_dot::test
