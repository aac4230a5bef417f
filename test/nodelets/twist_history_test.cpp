// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/twist_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace radar_dot {
namespace {

constexpr double kHold = 0.3;  // s
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Sample {
  double time, speed, yaw_rate;
};
TwistHistory historyOf(const std::vector<Sample>& samples) {
  TwistHistory history;
  for (const Sample& sample : samples)
    history.add({sample.time, {sample.speed, 0.0, 0.0}, {0.0, 0.0, sample.yaw_rate}});
  return history;
}

TwistHistory steadyHistory(double speed, double yaw_rate) {
  return historyOf({{10.0, speed, yaw_rate}, {10.5, speed, yaw_rate}, {11.0, speed, yaw_rate}});
}

Eigen::Matrix3d yaw(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Eigen::Isometry3d poseOf(double x, double y, double heading) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = yaw(heading);
  pose.translation() = Eigen::Vector3d(x, y, 0.0);
  return pose;
}

// Closed form of an arc that begins at the origin along x.
Eigen::Isometry3d arc(double speed, double yaw_rate, double dt) {
  const double angle = yaw_rate * dt;
  return poseOf(speed / yaw_rate * std::sin(angle), speed / yaw_rate * (1.0 - std::cos(angle)), angle);
}

void expectPose(const std::optional<Eigen::Isometry3d>& pose, const Eigen::Isometry3d& expected) {
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->matrix().isApprox(expected.matrix(), 1e-12)) << pose->matrix() << "\nexpected\n"
                                                                 << expected.matrix();
}

TEST(TwistHistory, StraightAtConstantSpeed) {
  const TwistHistory history = steadyHistory(10.0, 0.0);
  std::string missing;
  expectPose(history.motion(10.1, 10.9, kHold, missing), poseOf(8.0, 0.0, 0.0));
  expectPose(history.motion(10.2, 10.3, kHold, missing), poseOf(1.0, 0.0, 0.0));
  expectPose(history.motion(10.4, 10.4, kHold, missing), poseOf(0.0, 0.0, 0.0));
  EXPECT_EQ(missing, "") << "nothing was";
}

TEST(TwistHistory, ConstantYawRateIsAnArc) {
  const TwistHistory history = steadyHistory(10.0, 0.8);
  std::string missing;
  expectPose(history.motion(10.1, 10.9, kHold, missing), arc(10.0, 0.8, 0.8));
  expectPose(steadyHistory(10.0, -0.4).motion(10.0, 11.0, kHold, missing), arc(10.0, -0.4, 1.0));
}

TEST(TwistHistory, BackInTimeIsExactlyTheInverse) {
  const TwistHistory history = historyOf({{10.0, 3.0, 0.1}, {10.5, 9.0, 0.7}, {11.0, 5.0, -0.2}});
  std::string missing;
  const std::optional<Eigen::Isometry3d> ahead = history.motion(10.1, 10.9, kHold, missing);
  const std::optional<Eigen::Isometry3d> back = history.motion(10.9, 10.1, kHold, missing);
  ASSERT_TRUE(ahead);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->matrix(), ahead->inverse().matrix());
  EXPECT_GT(ahead->translation().x(), 1.0);
  EXPECT_LT(back->translation().x(), -1.0);
}

TEST(TwistHistory, MeanOfALinearAccelerationIsThatOfTheMiddle) {
  const TwistHistory history = historyOf({{10.0, 0.0, 0.0}, {10.5, 5.0, 0.2}, {11.0, 10.0, 0.4}});
  std::string missing;
  const std::optional<StampedVelocity> mean = history.mean(10.2, 10.9, kHold, missing);
  ASSERT_TRUE(mean);
  EXPECT_DOUBLE_EQ(mean->time, 10.55);
  EXPECT_NEAR(mean->linear.x(), 5.5, 1e-12);
  EXPECT_NEAR(mean->angular.z(), 0.22, 1e-12);
}

TEST(TwistHistory, MeanIsThatOfThePiecewiseLinearVelocity) {
  const TwistHistory history = historyOf({{10.0, 0.0, 0.0}, {10.5, 10.0, 0.0}, {11.0, 10.0, 1.0}});
  std::string missing;
  // Half a second at 5 m/s on average, and half a second at 10 m/s.
  EXPECT_NEAR(history.mean(10.0, 11.0, kHold, missing)->linear.x(), 7.5, 1e-12);
  // A quarter at (5 + 10) / 2 m/s, and a quarter at 10 m/s.
  EXPECT_NEAR(history.mean(10.25, 10.75, kHold, missing)->linear.x(), 8.75, 1e-12);
  // Nothing, and a quarter at (0 + 0.5) / 2 rad/s.
  EXPECT_NEAR(history.mean(10.25, 10.75, kHold, missing)->angular.z(), 0.125, 1e-12);
  // Between two velocities.
  EXPECT_NEAR(history.mean(10.1, 10.2, kHold, missing)->linear.x(), 3.0, 1e-12);
  EXPECT_NEAR(history.mean(10.1, 10.1, kHold, missing)->linear.x(), 2.0, 1e-12);
}

TEST(TwistHistory, EveryComponentIsUsed) {
  TwistHistory history;
  const Eigen::Vector3d linear(1.0, 2.0, 3.0), angular(0.0, 0.0, 0.0);
  history.add({10.0, linear, angular});
  history.add({10.5, linear, angular});
  std::string missing;
  const std::optional<Eigen::Isometry3d> motion = history.motion(10.0, 10.5, kHold, missing);
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->translation().isApprox(0.5 * linear, 1e-12));
}

TEST(TwistHistory, AGivenRotationReplacesTheYawRate) {
  const TwistHistory history = steadyHistory(10.0, 0.8);
  std::string missing;
  // 0.3 rad in half a second: as if the yaw rate had been 0.6 rad/s.
  expectPose(history.motion(10.25, 10.75, kHold, missing, yaw(0.3)), arc(10.0, 0.6, 0.5));
  // The other way the same arc is driven back; the rotation is that of the earlier in the frame of the later.
  expectPose(history.motion(10.75, 10.25, kHold, missing, yaw(-0.3)), arc(10.0, 0.6, 0.5).inverse());
}

TEST(TwistHistory, AVelocityHoldsForALimitedTime) {
  const TwistHistory history = historyOf({{10.0, 4.0, 0.0}, {10.5, 4.0, 0.0}, {11.0, 6.0, 0.0}});
  std::string missing;
  expectPose(history.motion(9.75, 10.25, kHold, missing), poseOf(2.0, 0.0, 0.0));
  expectPose(history.motion(11.0, 11.25, kHold, missing), poseOf(1.5, 0.0, 0.0));
  expectPose(history.motion(11.1, 11.25, kHold, missing), poseOf(0.9, 0.0, 0.0));
  EXPECT_EQ(missing, "");

  for (const bool reversed : {false, true}) {
    const auto motion = [&](double begin, double end) {
      missing.clear();
      return reversed ? history.motion(end, begin, kHold, missing)
                      : history.motion(begin, end, kHold, missing);
    };
    EXPECT_FALSE(motion(10.75, 11.5));
    EXPECT_EQ(missing, "the latest velocity is 0.50 s before the stamp");
    EXPECT_FALSE(motion(9.5, 10.5));
    EXPECT_EQ(missing, "the first velocity is 0.50 s after the stamp");
  }
  EXPECT_TRUE(history.motion(10.75, 11.5, 0.6, missing)) << "with a longer hold";
  EXPECT_FALSE(history.motion(10.0, 11.01, 0.0, missing)) << "with none";
}

TEST(TwistHistory, NothingIsKnownWithoutVelocities) {
  TwistHistory history;
  std::string missing;
  EXPECT_FALSE(history.motion(10.0, 10.5, kHold, missing));
  EXPECT_EQ(missing, "no velocity was received yet");
  EXPECT_FALSE(history.mean(10.0, 10.5, kHold, missing));
  EXPECT_EQ(history.latest(), nullptr);
}

TEST(TwistHistory, OneVelocityIsEnoughAroundIt) {
  const TwistHistory history = historyOf({{10.0, 4.0, 0.0}});
  std::string missing;
  expectPose(history.motion(9.75, 10.25, kHold, missing), poseOf(2.0, 0.0, 0.0));
}

TEST(TwistHistory, NothingIsInterpolatedAcrossAGap) {
  const TwistHistory history =
      historyOf({{10.0, 4.0, 0.0}, {10.5, 4.0, 0.0}, {12.0, 8.0, 0.0}, {12.5, 8.0, 0.0}});
  std::string missing;
  expectPose(history.motion(10.0, 10.5, kHold, missing), poseOf(2.0, 0.0, 0.0));
  expectPose(history.motion(12.0, 12.5, kHold, missing), poseOf(4.0, 0.0, 0.0));
  EXPECT_TRUE(history.mean(10.5, 10.5, kHold, missing)) << "its border is known";
  EXPECT_EQ(missing, "");
  struct Interval {
    double begin, end;
  };
  for (const Interval& interval : {Interval{10.4, 10.6}, {11.0, 11.2}, {11.9, 12.1}, {10.0, 12.5}}) {
    missing.clear();
    EXPECT_FALSE(history.motion(interval.begin, interval.end, kHold, missing)) << interval.begin;
    EXPECT_EQ(missing, "the velocities have a gap of 1.50 s");
  }
  EXPECT_FALSE(history.mean(11.0, 11.0, kHold, missing)) << "a single time within it";
}

TEST(TwistHistory, OldVelocitiesAreDropped) {
  TwistHistory history(2.0);
  for (int i = 0; i <= 6; ++i) history.add({10.0 + 0.5 * i, {1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  std::string missing;
  EXPECT_TRUE(history.motion(11.0, 13.0, 0.0, missing)) << missing;
  EXPECT_FALSE(history.motion(10.9, 13.0, 0.0, missing));
  EXPECT_EQ(missing, "the first velocity is 0.10 s after the stamp");
}

TEST(TwistHistory, OnlyLaterVelocitiesAreTaken) {
  TwistHistory history = historyOf({{10.0, 1.0, 0.0}, {10.5, 2.0, 0.0}});
  history.add({10.5, {99.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  history.add({10.2, {99.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  ASSERT_NE(history.latest(), nullptr);
  EXPECT_EQ(history.latest()->time, 10.5);
  EXPECT_EQ(history.latest()->linear.x(), 2.0);
  std::string missing;
  EXPECT_NEAR(history.mean(10.0, 10.5, kHold, missing)->linear.x(), 1.5, 1e-12);
  history.clear();
  EXPECT_EQ(history.latest(), nullptr);
  history.add({5.0, {3.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  ASSERT_NE(history.latest(), nullptr) << "time may be reset";
  EXPECT_EQ(history.latest()->time, 5.0);
}

geometry_msgs::TwistWithCovarianceStamped twistMessage() {
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
  const geometry_msgs::TwistWithCovarianceStamped good = twistMessage();
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
}

// Only a vertical motion has a likely value where it is not observed.
TEST(VelocityOf, UnobservedVerticalMotionIsZero) {
  const auto components = [](const StampedVelocity& velocity) {
    return std::vector<double>{velocity.linear.x(),  velocity.linear.y(),  velocity.linear.z(),
                               velocity.angular.x(), velocity.angular.y(), velocity.angular.z()};
  };
  EXPECT_EQ(velocityOf(twistMessage()).time, 12.5);
  const std::vector<double> observed{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  EXPECT_EQ(components(velocityOf(twistMessage())), observed);
  for (std::size_t i = 0; i < 6; ++i) {
    geometry_msgs::TwistWithCovarianceStamped twist = twistMessage();
    twist.twist.covariance[7 * i] = 1e6;
    std::vector<double> expected = observed;
    if (i >= 2 && i <= 4) expected[i] = 0.0;
    EXPECT_EQ(components(velocityOf(twist)), expected) << "component " << i;
    twist.twist.covariance[7 * i] = 100.0;
    EXPECT_EQ(components(velocityOf(twist)), observed) << "known badly is not unknown, component " << i;
  }
}

}  // namespace
}  // namespace radar_dot
