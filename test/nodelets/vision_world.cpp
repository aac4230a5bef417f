// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vision_world.h"

#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "fixtures/camera_mount.h"
#include "nodelets/float_cloud.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot::test {

CameraIntrinsics VisionWorld::camera() { return {200.0, 200.0, 159.5, 89.5, kWidth, kHeight}; }

Eigen::Isometry3d VisionWorld::T_base_from_camera() { return lookingAhead({1.7, 0.1, 1.5}); }

geometry_msgs::TransformStamped VisionWorld::mount() {
  const Eigen::Isometry3d T = T_base_from_camera();
  const Eigen::Quaterniond q(T.linear());
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = "base_link";
  transform.child_frame_id = kCameraFrame;
  transform.transform.translation.x = T.translation().x();
  transform.transform.translation.y = T.translation().y();
  transform.transform.translation.z = T.translation().z();
  transform.transform.rotation.w = q.w();
  transform.transform.rotation.x = q.x();
  transform.transform.rotation.y = q.y();
  transform.transform.rotation.z = q.z();
  return transform;
}

geometry_msgs::TwistWithCovarianceStamped VisionWorld::twist(const ros::Time& stamp) {
  geometry_msgs::TwistWithCovarianceStamped twist;
  twist.header.stamp = stamp;
  twist.header.frame_id = "base_link";
  twist.twist.twist.linear.x = kSpeed;
  twist.twist.twist.angular.z = kYawRate;
  return twist;
}

sensor_msgs::CameraInfo VisionWorld::cameraInfo(const ros::Time& stamp) {
  const CameraIntrinsics camera = VisionWorld::camera();
  sensor_msgs::CameraInfo info;
  info.header.stamp = stamp;
  info.header.frame_id = kCameraFrame;
  info.width = kWidth;
  info.height = kHeight;
  info.K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

sensor_msgs::Image VisionWorld::depth(const ros::Time& stamp) {
  return imageOf(stamp, "32FC1", cv::Mat(kGridHeight, kGridWidth, CV_32FC1, cv::Scalar(kDepth)));
}

Flow VisionWorld::flow(const ros::Time& first, const ros::Time& second) {
  const double dt = second.toSec() - first.toSec();
  const Eigen::Isometry3d motion = baseMotion({kSpeed, 0.0, 0.0}, {0.0, 0.0, kYawRate}, std::abs(dt));
  const Eigen::Isometry3d T_second_from_first =
      staticPointMotion(T_base_from_camera(), dt > 0.0 ? motion : motion.inverse());
  cv::Mat field = expectedFlow(camera().scaledTo(kGridWidth, kGridHeight), T_second_from_first,
                               cv::Mat(kGridHeight, kGridWidth, CV_32FC1, cv::Scalar(kDepth)));
  constexpr double kPatchSpeed = 80.0;  // px of the grid per second
  field(patch()) += cv::Scalar(kPatchSpeed * dt, 0.0);
  Flow flow;
  flow.header.stamp = first;
  flow.header.frame_id = kCameraFrame;
  flow.second_stamp = second;
  flow.image_width = kWidth;
  flow.image_height = kHeight;
  flow.flow = imageOf(first, "32FC2", field);
  return flow;
}

sensor_msgs::Image VisionWorld::image(const ros::Time& stamp, double shift, const std::string& encoding) {
  cv::Mat texture(kHeight, kWidth, CV_8UC1);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double x = column - shift;
      // Waves of several lengths and directions: nothing repeats within the image.
      const double value = 128.0 + 40.0 * std::sin(0.31 * x + 0.07 * row) +
                           35.0 * std::sin(0.11 * x - 0.23 * row) +
                           30.0 * std::sin(0.047 * x + 0.19 * row + 1.0);
      texture.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(value);
    }
  }
  if (encoding != "mono8") cv::cvtColor(texture, texture, cv::COLOR_GRAY2BGR);
  return imageOf(stamp, encoding, texture);
}

sensor_msgs::Image imageOf(const ros::Time& stamp, const std::string& encoding, const cv::Mat& pixels) {
  sensor_msgs::Image message;
  message.header.stamp = stamp;
  message.header.frame_id = VisionWorld::kCameraFrame;
  message.encoding = encoding;
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.step = static_cast<std::uint32_t>(static_cast<std::size_t>(pixels.cols) * pixels.elemSize());
  const cv::Mat packed = pixels.clone();
  message.data.assign(packed.data, packed.data + packed.total() * packed.elemSize());
  return message;
}

cv::Mat matOf(const sensor_msgs::Image& message, int type) {
  cv::Mat pixels(static_cast<int>(message.height), static_cast<int>(message.width), type);
  if (pixels.total() * pixels.elemSize() != message.data.size()) return {};
  std::memcpy(pixels.data, message.data.data(), message.data.size());
  return pixels;
}

sensor_msgs::PointCloud2 cloudOf(const ros::Time& stamp, const std::string& frame,
                                 const std::vector<Eigen::Vector3f>& points) {
  std::vector<float> values;
  for (const Eigen::Vector3f& point : points) values.insert(values.end(), point.data(), point.data() + 3);
  sensor_msgs::PointCloud2 cloud = floatCloud({"x", "y", "z"}, values);
  cloud.header.stamp = stamp;
  cloud.header.frame_id = frame;
  return cloud;
}

}  // namespace radar_dot::test
