// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Inputs of nodelets that need topics, without a nodelet.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>

#include <algorithm>

#include "live_graph.h"
#include "nodelets/inputs/mask_input.h"
#include "nodelets/inputs/rotation_source.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

constexpr double kPatience = 10.0;  // s; machines are slow at times

class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    handle_.setCallbackQueue(&queue_);
    extrinsics_.buffer().setTransform(VisionWorld::mount(), "test", true);
  }
  /// Serves messages until the condition holds.
  bool serveUntil(const std::function<bool()>& condition) {
    return waitUntil([&] { return queue_.callAvailable(), condition(); }, kPatience);
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle handle_{"inputs"};
  Extrinsics extrinsics_{"base_link", handle_};
};

// A message that is served before its owner holds the source would find a null pointer.
TEST_F(Inputs, ARotationSourceListensOnceItIsStarted) {
  const auto listens = [] {
    ros::V_string topics;
    ros::this_node::getSubscribedTopics(topics);
    return std::count(topics.begin(), topics.end(), "/inputs/rotation/odom") > 0;
  };
  std::unique_ptr<RotationSource> source;
  std::size_t samples = 0;
  RotationSource::Callbacks callbacks{[] {}, [&] { ++samples; }, [] {}, [](const std::string&) {}};
  RotationParams params;
  params.source = RotationSourceKind::kOdometry;
  source = makeRotationSource(params, handle_, extrinsics_, callbacks);
  EXPECT_FALSE(listens());
  EXPECT_EQ(source->describe(), "odometry on '/inputs/rotation/odom'");
  source->start();
  EXPECT_TRUE(listens());

  nav_msgs::Odometry odometry;
  odometry.header.stamp = ros::Time::now();
  odometry.pose.pose.orientation.w = 1.0;
  ros::Publisher publisher = handle_.advertise<nav_msgs::Odometry>("rotation/odom", 1, true);
  publisher.publish(odometry);
  EXPECT_TRUE(serveUntil([&] { return samples == 1; }));
  EXPECT_EQ(source->latest(), odometry.header.stamp.toSec());
}

TEST_F(Inputs, AMaskInputThatWasSwitchedOffHasForgottenItsVelocities) {
  const ros::Time stamp = ros::Time::now() - ros::Duration(0.1);
  const cv::Mat pixels(VisionWorld::kHeight, VisionWorld::kWidth, CV_8UC1, cv::Scalar(255));
  ros::Publisher masks = handle_.advertise<sensor_msgs::Image>("dynamic/mask", 1, true);
  ros::Publisher cameras = handle_.advertise<sensor_msgs::CameraInfo>("camera_info", 1, true);
  masks.publish(imageOf(stamp, "mono8", pixels));
  cameras.publish(VisionWorld::cameraInfo(stamp));

  MaskInput input(handle_, extrinsics_, [](const std::string&) {});
  DopplerReturn ahead;
  ahead.range = 20.F;
  const auto marked = [&] {
    return input.marked({ahead}, Eigen::Isometry3d::Identity(), stamp + ros::Duration(0.05));
  };
  const auto complaint = [&] {
    marked();
    diagnostic_updater::DiagnosticStatusWrapper status;
    input.report(status);
    return status.message;
  };
  EgoVelocityConfig config;
  config.use_mask = true;
  input.configure(config);
  input.add({stamp.toSec(), {8.0, 0.0, 0.0}});
  ASSERT_TRUE(serveUntil([&] { return marked() == std::vector<std::uint8_t>{1}; })) << complaint();

  config.use_mask = false;
  input.configure(config);
  config.use_mask = true;
  input.configure(config);
  EXPECT_TRUE(serveUntil([&] {
    return complaint().find("no velocity was received yet") != std::string::npos;
  })) << complaint();
}

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inputs_test");
  const ros::NodeHandle keeper;
  return RUN_ALL_TESTS();
}
