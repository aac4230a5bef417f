// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "live_mask.h"

#include <gtest/gtest.h>

#include <cmath>

#include "object_scene.h"

namespace radar_dot::test {

void LiveMask::send(double seconds, const Eigen::Vector2d& position, const Eigen::Vector2d& velocity) {
  const CameraIntrinsics camera = VisionWorld::camera();
  const Eigen::Isometry3d T_camera_from_base = VisionWorld::T_base_from_camera().inverse();
  const Eigen::Vector3d there = T_camera_from_base * Eigen::Vector3d(position.x(), position.y(), 0.75);
  const Eigen::Vector3d moves =
      T_camera_from_base.linear() * Eigen::Vector3d(velocity.x(), velocity.y(), 0.0);
  const Eigen::Vector2d pixel = camera.project(there);
  const cv::Rect region(static_cast<int>(std::lround(pixel.x())) - kWidth / 2,
                        static_cast<int>(std::lround(pixel.y())) - kHeight / 2, kWidth, kHeight);
  const cv::Size size(VisionWorld::kWidth, VisionWorld::kHeight);
  ASSERT_EQ((region & cv::Rect({0, 0}, size)).area(), kWidth * kHeight) << "not in the image";
  constexpr double kInterval = -0.1;  // s, to the previous image
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1), flow = cv::Mat::zeros(size, CV_32FC2);
  mask(region) = 255;
  flow(region) =
      cv::Scalar(kInterval * (camera.fx * moves.x() - (pixel.x() - camera.cx) * moves.z()) / there.z());
  const ros::Time stamp = ObjectScene::stampAt(seconds);
  Flow message;
  message.header.stamp = stamp;
  message.header.frame_id = VisionWorld::kCameraFrame;
  message.second_stamp = stamp + ros::Duration(kInterval);
  message.image_width = VisionWorld::kWidth;
  message.image_height = VisionWorld::kHeight;
  message.flow = imageOf(stamp, "32FC2", flow);
  camera_.publish(VisionWorld::cameraInfo(stamp));
  depth_.publish(imageOf(stamp, "32FC1", cv::Mat(size, CV_32FC1, cv::Scalar(there.z()))));
  flow_.publish(message);
  mask_.publish(imageOf(stamp, "mono8", mask));
  expected_.publish(imageOf(stamp, "32FC2", cv::Mat::zeros(size, CV_32FC2)));
  box = region;
  last = stamp;
}

}  // namespace radar_dot::test
