// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/ego_messages.h"

#include <gtest/gtest.h>

#include <limits>

namespace radar_dot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

geometry_msgs::TwistWithCovarianceStamped filledMessage() {
  geometry_msgs::TwistWithCovarianceStamped twist;
  twist.header.frame_id = "base_link";
  twist.header.stamp = ros::Time(12, 500000000);
  geometry_msgs::Twist& velocity = twist.twist.twist;
  velocity.linear.x = 1.0;
  velocity.linear.y = 2.0;
  velocity.linear.z = 3.0;
  velocity.angular.x = 4.0;
  velocity.angular.y = 5.0;
  velocity.angular.z = 6.0;
  return twist;
}

TEST(TwistDefect, NamesTheFrameAndWhatIsNotFinite) {
  const geometry_msgs::TwistWithCovarianceStamped good = filledMessage();
  EXPECT_EQ(twistDefect(good, "base_link"), "");
  const std::string other = twistDefect(good, "base_footprint");
  EXPECT_NE(other.find("'base_link'"), std::string::npos) << other;
  EXPECT_NE(other.find("'base_footprint'"), std::string::npos) << other;

  const auto defect = [&good](auto change) {
    geometry_msgs::TwistWithCovarianceStamped twist = good;
    change(twist.twist);
    return twistDefect(twist, "base_link");
  };
  EXPECT_EQ(defect([](auto& twist) { twist.twist.linear.x = kNaN; }), "it is not finite");
  EXPECT_EQ(defect([](auto& twist) { twist.twist.linear.z = kNaN; }), "it is not finite");
  EXPECT_EQ(defect([](auto& twist) { twist.twist.angular.z = std::numeric_limits<double>::infinity(); }),
            "it is not finite");
  EXPECT_EQ(defect([](auto& twist) { twist.covariance[35] = kNaN; }), "it is not finite");
  EXPECT_NE(defect([](auto& twist) { twist.covariance[7] = -1.0; }).find("negative"), std::string::npos);
  EXPECT_NE(defect([](auto& twist) { twist.twist.linear.y = 1e38; }).find("faster"), std::string::npos);
  EXPECT_EQ(defect([](auto& twist) { twist.covariance[14] = 1e9; }), "") << "as many say: not measured";
  EXPECT_EQ(twistDefect(good, "base_link"), "");
  geometry_msgs::TwistWithCovarianceStamped slashed = good;
  slashed.header.frame_id = "/base_link";
  EXPECT_EQ(twistDefect(slashed, "base_link"), "") << "as drivers from the days of tf have it";
}

TEST(TwistOf, ReadsEveryComponent) {
  geometry_msgs::TwistWithCovarianceStamped message = filledMessage();
  message.twist.covariance[6 * 5 + 1] = 0.7;
  const StampedTwist twist = twistOf(message);
  EXPECT_EQ(twist.time, 12.5);
  EXPECT_EQ(twist.linear, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(twist.angular, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(twist.covariance(5, 1), 0.7);
  EXPECT_EQ(twist.covariance.sum(), 0.7);
}

}  // namespace
}  // namespace radar_dot
