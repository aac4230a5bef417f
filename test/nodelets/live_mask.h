// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "vision_world.h"

namespace radar_dot::test {

/// Sends the images in which a region stands for something at a place, base frame.
class LiveMask {
 public:
  explicit LiveMask(ros::NodeHandle& handle)
      : mask_(handle.advertise<sensor_msgs::Image>("dynamic/mask", 5)),
        depth_(handle.advertise<sensor_msgs::Image>("depth", 5)),
        expected_(handle.advertise<sensor_msgs::Image>("dynamic/expected_flow", 5)),
        flow_(handle.advertise<Flow>("flow", 5)),
        camera_(handle.advertise<sensor_msgs::CameraInfo>("camera/camera_info", 5)) {
    broadcaster_.sendTransform(VisionWorld::mount());
  }
  bool heard() const {
    return mask_.getNumSubscribers() * depth_.getNumSubscribers() * expected_.getNumSubscribers() *
               flow_.getNumSubscribers() * camera_.getNumSubscribers() >
           0;
  }
  static constexpr int kWidth = 24, kHeight = 12;  // px, of the region

  /// @param position  m, base frame at `seconds`   @param velocity  m/s over ground, base frame
  void send(double seconds, const Eigen::Vector2d& position, const Eigen::Vector2d& velocity);

  cv::Rect box;  // px, of the latest image
  ros::Time last;

 private:
  ros::Publisher mask_, depth_, expected_, flow_, camera_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
};

}  // namespace radar_dot::test
