// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Inputs of nodelets that need topics, without a nodelet.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>

#include <algorithm>

#include "live_graph.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/rotation_source.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    handle_.setCallbackQueue(&queue_);
    extrinsics_.buffer().setTransform(VisionWorld::mount(), "test", true);
  }
  /// Serves messages until the condition holds.
  bool serveUntil(const std::function<bool()>& condition) {
    return waitUntil([&] { return queue_.callAvailable(), condition(); });
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

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inputs_test");
  const ros::NodeHandle keeper;
  return RUN_ALL_TESTS();
}
