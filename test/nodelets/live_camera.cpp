// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "live_camera.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "vision_world.h"

namespace radar_dot::test {
namespace {

using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

constexpr double kWrap = 64.0;  // px; the texture starts again after so many

CompressedImage compress(const Image& image) {
  CompressedImage compressed;
  compressed.header = image.header;
  compressed.format = "png";
  cv::imencode(".png", matOf(image, CV_8UC1), compressed.data);
  return compressed;
}

}  // namespace

LiveCamera::LiveCamera(ros::NodeHandle& handle)
    : image_(handle.advertise<Image>("image", 10)),
      compressed_(handle.advertise<CompressedImage>("image/compressed", 10)),
      depth_(handle.advertise<Image>("test/depth", 10)),
      camera_(handle.advertise<sensor_msgs::CameraInfo>("camera_info", 10)),
      twist_(handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10)),
      radar_(handle.advertise<sensor_msgs::PointCloud2>("radar", 10)),
      lidar_(handle.advertise<sensor_msgs::PointCloud2>("lidar", 10)),
      mask_(handle.advertise<Image>("test/mask", 10)),
      valid_(handle.advertise<Image>("test/valid", 10)),
      expected_(handle.advertise<Image>("test/expected_flow", 10)),
      ticker_(1.0 / VisionWorld::kPeriod, [this] { publish(); }) {
  broadcaster_.sendTransform(VisionWorld::mount());
}

void LiveCamera::set(const Fault& fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  fault_ = fault;
}

void LiveCamera::publish() {
  const ros::Time stamp = ros::Time::now();
  Frame frame;
  frame.image = VisionWorld::image(stamp, std::fmod(kShift * count_++, kWrap));
  frame.compressed = compress(frame.image);
  frame.depth = imageOf(stamp, "16UC1", cv::Mat(180, 320, CV_16UC1, cv::Scalar(7500)));
  frame.mask = imageOf(stamp, "mono8", cv::Mat::zeros(180, 320, CV_8UC1));
  frame.twist = VisionWorld::twist(stamp);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (fault_) fault_(frame);
  }
  // The scans are a tenth of a second old when the image is taken: the vehicle has come nearer.
  const ros::Time scan = stamp - ros::Duration(0.1);
  twist_.publish(frame.twist);
  camera_.publish(VisionWorld::cameraInfo(stamp));
  radar_.publish(cloudOf(scan, "base_link", {{kReturnAhead, 0.0F, 0.5F}}));
  lidar_.publish(cloudOf(scan, "base_link", {{kReturnAhead, 0.0F, 1.5F}, {NAN, 0.0F, 0.0F}}));
  ros::WallDuration(0.01).sleep();  // so that they are there before the image
  image_.publish(frame.image);
  compressed_.publish(frame.compressed);
  depth_.publish(frame.depth);
  mask_.publish(frame.mask);
  valid_.publish(imageOf(stamp, "mono8", cv::Mat(180, 320, CV_8UC1, cv::Scalar(255))));
  expected_.publish(imageOf(stamp, "32FC2", cv::Mat::zeros(90, 160, CV_32FC2)));
}

}  // namespace radar_dot::test
