// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/Flow.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot::test {

/// A vehicle that drives an arc before a wall, its camera, and a patch of the image that moves independently.
/// Everything is constant in time, so that any two images make the same pair.
struct VisionWorld {
  static constexpr int kWidth = 320, kHeight = 180;         ///< px, of the images
  static constexpr int kGridWidth = 160, kGridHeight = 90;  ///< px, of flow and depth
  static constexpr double kDepth = 20.0;                    ///< m, of every pixel of every image
  static constexpr double kSpeed = 8.0, kYawRate = 0.1;     ///< m/s, rad/s
  static constexpr double kPeriod = 0.1;                    ///< s between images
  static constexpr const char* kCameraFrame = "camera";

  /// px of the grid; what moves independently, by 8 px to the right.
  static cv::Rect patch() { return {90, 30, 24, 20}; }
  static CameraIntrinsics camera();  ///< of the images
  static Eigen::Isometry3d T_base_from_camera();
  static geometry_msgs::TransformStamped mount();  ///< base_link -> camera

  static geometry_msgs::TwistWithCovarianceStamped twist(const ros::Time& stamp);
  static sensor_msgs::CameraInfo cameraInfo(const ros::Time& stamp);
  static sensor_msgs::Image depth(const ros::Time& stamp);
  /// Flow on the grid of the image at `first`; the patch moves to the right in time, whichever is first.
  static Flow flow(const ros::Time& first, const ros::Time& second);
  /// A texture moved by `shift` px to the right. @param encoding  mono8, bgr8 or rgb8
  static sensor_msgs::Image image(const ros::Time& stamp, double shift,
                                  const std::string& encoding = "mono8");
};

/// An image message of any encoding. @param pixels  its bytes are taken as they are
sensor_msgs::Image imageOf(const ros::Time& stamp, const std::string& encoding, const cv::Mat& pixels);
cv::Mat matOf(const sensor_msgs::Image& message, int type);
/// A cloud with the fields x, y, z (float32).
sensor_msgs::PointCloud2 cloudOf(const ros::Time& stamp, const std::string& frame,
                                 const std::vector<Eigen::Vector3f>& points);

}  // namespace radar_dot::test
