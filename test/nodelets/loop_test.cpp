// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// A bag that starts again: time goes back, and the nodelets go on at once.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Log.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>

#include "fixtures/files.h"
#include "live_graph.h"
#include "synthetic_bag.h"

namespace radar_dot::test {
namespace {

constexpr double kDuration = 5.0;  // s of the drive

// Stamps of a topic, cut where they go back.
template <typename Message>
std::vector<std::vector<boost::shared_ptr<const Message>>> rounds(
    const std::vector<boost::shared_ptr<const Message>>& messages) {
  std::vector<std::vector<boost::shared_ptr<const Message>>> result(1);
  for (const auto& message : messages) {
    if (!result.back().empty() && message->header.stamp < result.back().back()->header.stamp)
      result.emplace_back();
    result.back().push_back(message);
  }
  return result;
}

TEST(LoopTest, EachRoundOfTheBagIsLikeTheFirst) {
  ros::NodeHandle handle;
  const Recorder<geometry_msgs::TwistWithCovarianceStamped> twists(handle, "ego/twist");
  const Recorder<nav_msgs::Odometry> odometry(handle, "odom");
  const Recorder<tf2_msgs::TFMessage> tf(handle, "/tf");
  const Recorder<rosgraph_msgs::Log> log(handle, "/rosout");
  const SyntheticDrive drive(kDuration);
  const TemporaryFolder folder;
  const std::string bag = (folder.path() / "drive.bag").string();
  writeSyntheticBag(drive, bag);
  ASSERT_TRUE(waitUntil([&] { return twists.connected() && odometry.connected(); }));
  {
    // /tf of the bag would give base_link a second parent. The mounts come in the first round only.
    BagPlayer player({"--clock", "--rate=2", "--delay=1.5", "--loop", bag, "--topics", "/tf_static",
                      "/radar_front", "/radar_front_left", "/radar_front_right", "/radar_back_left",
                      "/radar_back_right", "/ground_truth/odom"});
    const auto full_rounds = [&] { return rounds(odometry.messages()).size() >= 4; };
    ASSERT_TRUE(waitUntil(full_rounds, 60.0)) << "time did not go back, or the nodelets stopped";
  }

  const auto twist_rounds = rounds(twists.messages());
  const auto odometry_rounds = rounds(odometry.messages());
  ASSERT_GE(twist_rounds.size(), 3U);
  const std::size_t complete = odometry_rounds.size() - 1;
  for (std::size_t round = 0; round < complete; ++round) {
    EXPECT_GT(twist_rounds.at(round).size(), static_cast<std::size_t>(0.8 * 13.0 * kDuration))
        << "round " << round;
    const auto& poses = odometry_rounds.at(round);
    ASSERT_GT(poses.size(), static_cast<std::size_t>(0.7 * 13.0 * kDuration)) << "round " << round;
    for (const nav_msgs::OdometryConstPtr& pose : poses) {
      const TrueState truth = drive.at(pose->header.stamp.toSec() - SyntheticDrive::kStart);
      EXPECT_NEAR(pose->pose.pose.position.x, truth.x, 0.3)
          << "round " << round << ": something of the round before";
      EXPECT_NEAR(pose->pose.pose.position.y, truth.y, 0.3) << "round " << round;
    }
  }
  for (std::size_t round = 1; round < complete; ++round) {
    const double first = twist_rounds.at(round).front()->header.stamp.toSec() - SyntheticDrive::kStart;
    EXPECT_LT(first, 0.5) << "round " << round << " did not go on at once";
  }
  // One of the nodelets says once per round that it resets (the last round may have come just now).
  std::size_t resets = 0, refused = 0;
  for (const rosgraph_msgs::LogConstPtr& line : log.messages()) {
    resets += line->msg.find("resetting") != std::string::npos ? 1 : 0;
    refused += line->msg.find("not newer than the previous") != std::string::npos ? 1 : 0;
  }
  EXPECT_LE(refused, 2 * complete) << "a message may come before the clock that goes with it, and no more";
  EXPECT_NEAR(static_cast<double>(resets), static_cast<double>(complete), 1.0);
  const auto messages = tf.messages();
  EXPECT_TRUE(std::any_of(messages.begin(), messages.end(), [](const tf2_msgs::TFMessageConstPtr& message) {
    return message->transforms.front().header.frame_id == "odom" &&
           message->transforms.front().child_frame_id == "base_link";
  })) << "publish_tf is on by default";
}

}  // namespace
}  // namespace radar_dot::test
