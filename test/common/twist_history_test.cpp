// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/twist_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace radar_dot {
namespace {

constexpr double kHold = 0.3;  // s

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

std::optional<Eigen::Isometry3d> motionOf(const TwistHistory& history, double begin, double end,
                                          std::string& missing, double max_hold = kHold) {
  IntervalMotion motion = history.between(begin, end, max_hold);
  if (!motion.T_begin_from_end) missing = motion.missing;
  return motion.T_begin_from_end;
}

void expectPose(const std::optional<Eigen::Isometry3d>& pose, const Eigen::Isometry3d& expected) {
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->matrix().isApprox(expected.matrix(), 1e-12)) << pose->matrix() << "\nexpected\n"
                                                                 << expected.matrix();
}

TEST(TwistHistory, StraightAtConstantSpeed) {
  const TwistHistory history = steadyHistory(10.0, 0.0);
  std::string missing;
  expectPose(motionOf(history, 10.1, 10.9, missing), poseOf(8.0, 0.0, 0.0));
  expectPose(motionOf(history, 10.2, 10.3, missing), poseOf(1.0, 0.0, 0.0));
  expectPose(motionOf(history, 10.4, 10.4, missing), poseOf(0.0, 0.0, 0.0));
  EXPECT_EQ(missing, "") << "nothing was";
}

TEST(TwistHistory, ConstantYawRateIsAnArc) {
  const TwistHistory history = steadyHistory(10.0, 0.8);
  std::string missing;
  expectPose(motionOf(history, 10.1, 10.9, missing), arc(10.0, 0.8, 0.8));
  expectPose(motionOf(steadyHistory(10.0, -0.4), 10.0, 11.0, missing), arc(10.0, -0.4, 1.0));
}

TEST(TwistHistory, BackInTimeIsExactlyTheInverse) {
  const TwistHistory history = historyOf({{10.0, 3.0, 0.1}, {10.5, 9.0, 0.7}, {11.0, 5.0, -0.2}});
  std::string missing;
  const std::optional<Eigen::Isometry3d> ahead = motionOf(history, 10.1, 10.9, missing);
  const std::optional<Eigen::Isometry3d> back = motionOf(history, 10.9, 10.1, missing);
  ASSERT_TRUE(ahead);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->matrix(), ahead->inverse().matrix());
  EXPECT_GT(ahead->translation().x(), 1.0);
  EXPECT_LT(back->translation().x(), -1.0);
}

TEST(TwistHistory, MeanOfALinearAccelerationIsThatOfTheMiddle) {
  const TwistHistory history = historyOf({{10.0, 0.0, 0.0}, {10.5, 5.0, 0.2}, {11.0, 10.0, 0.4}});
  std::string missing;
  const std::optional<StampedTwist> mean = history.mean(10.2, 10.9, kHold, missing);
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
  const std::optional<Eigen::Isometry3d> motion = motionOf(history, 10.0, 10.5, missing);
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->translation().isApprox(0.5 * linear, 1e-12));
}

TEST(TwistHistory, AGivenRotationReplacesTheYawRate) {
  const TwistHistory history = steadyHistory(10.0, 0.8);
  const Eigen::Quaterniond early(yaw(1.0)), late(yaw(1.3));
  // 0.3 rad in half a second: as if the yaw rate had been 0.6 rad/s.
  const KnownRotation rotation{"a gyro", early, late};
  expectPose(history.between(10.25, 10.75, kHold, &rotation).T_begin_from_end, arc(10.0, 0.6, 0.5));
  // The other way the same arc is driven back.
  const KnownRotation back{"a gyro", late, early};
  expectPose(history.between(10.75, 10.25, kHold, &back, true).T_begin_from_end,
             arc(10.0, 0.6, 0.5).inverse());
}

TEST(TwistHistory, TheTwistsStandInForALateRotation) {
  const TwistHistory history = steadyHistory(10.0, 0.8);
  const KnownRotation half{"a gyro", Eigen::Quaterniond::Identity(), std::nullopt};
  const IntervalMotion waiting = history.between(10.25, 10.75, kHold, &half, true);
  EXPECT_FALSE(waiting.T_begin_from_end);
  EXPECT_EQ(waiting.missing, "no rotation at the stamps of the images from a gyro");
  const IntervalMotion without = history.between(10.25, 10.75, kHold, &half, false);
  expectPose(without.T_begin_from_end, arc(10.0, 0.8, 0.5));
  EXPECT_TRUE(without.without_rotation);
  EXPECT_FALSE(history.between(10.25, 10.75, kHold).without_rotation) << "nobody asked for one";
}

TEST(TwistHistory, AVelocityHoldsForALimitedTime) {
  const TwistHistory history = historyOf({{10.0, 4.0, 0.0}, {10.5, 4.0, 0.0}, {11.0, 6.0, 0.0}});
  std::string missing;
  expectPose(motionOf(history, 9.75, 10.25, missing), poseOf(2.0, 0.0, 0.0));
  expectPose(motionOf(history, 11.0, 11.25, missing), poseOf(1.5, 0.0, 0.0));
  expectPose(motionOf(history, 11.1, 11.25, missing), poseOf(0.9, 0.0, 0.0));
  EXPECT_EQ(missing, "");

  for (const bool reversed : {false, true}) {
    const auto motion = [&](double begin, double end) {
      missing.clear();
      return reversed ? motionOf(history, end, begin, missing) : motionOf(history, begin, end, missing);
    };
    EXPECT_FALSE(motion(10.75, 11.5));
    EXPECT_EQ(missing, "the latest velocity is 0.50 s before the stamp");
    EXPECT_FALSE(motion(9.5, 10.5));
    EXPECT_EQ(missing, "the first velocity is 0.50 s after the stamp");
  }
  EXPECT_TRUE(motionOf(history, 10.75, 11.5, missing, 0.6)) << "with a longer hold";
  EXPECT_FALSE(motionOf(history, 10.0, 11.01, missing, 0.0)) << "with none";
}

TEST(TwistHistory, NothingIsKnownWithoutVelocities) {
  TwistHistory history;
  std::string missing;
  EXPECT_FALSE(motionOf(history, 10.0, 10.5, missing));
  EXPECT_EQ(missing, "no velocity was received yet");
  EXPECT_FALSE(history.mean(10.0, 10.5, kHold, missing));
  EXPECT_EQ(history.latest(), nullptr);
}

TEST(TwistHistory, OneVelocityIsEnoughAroundIt) {
  const TwistHistory history = historyOf({{10.0, 4.0, 0.0}});
  std::string missing;
  expectPose(motionOf(history, 9.75, 10.25, missing), poseOf(2.0, 0.0, 0.0));
}

TEST(TwistHistory, NothingIsInterpolatedAcrossAGap) {
  const TwistHistory history =
      historyOf({{10.0, 4.0, 0.0}, {10.5, 4.0, 0.0}, {12.0, 8.0, 0.0}, {12.5, 8.0, 0.0}});
  std::string missing;
  expectPose(motionOf(history, 10.0, 10.5, missing), poseOf(2.0, 0.0, 0.0));
  expectPose(motionOf(history, 12.0, 12.5, missing), poseOf(4.0, 0.0, 0.0));
  EXPECT_TRUE(history.mean(10.5, 10.5, kHold, missing)) << "its border is known";
  EXPECT_EQ(missing, "");
  struct Interval {
    double begin, end;
  };
  for (const Interval& interval : {Interval{10.4, 10.6}, {11.0, 11.2}, {11.9, 12.1}, {10.0, 12.5}}) {
    missing.clear();
    EXPECT_FALSE(motionOf(history, interval.begin, interval.end, missing)) << interval.begin;
    EXPECT_EQ(missing, "the velocities have a gap of 1.50 s");
  }
  EXPECT_FALSE(history.mean(11.0, 11.0, kHold, missing)) << "a single time within it";
}

TEST(TwistHistory, OldVelocitiesAreDropped) {
  TwistHistory history(2.0);
  for (int i = 0; i <= 6; ++i) history.add({10.0 + 0.5 * i, {1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  std::string missing;
  EXPECT_TRUE(motionOf(history, 11.0, 13.0, missing, 0.0)) << missing;
  EXPECT_FALSE(motionOf(history, 10.9, 13.0, missing, 0.0));
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

TEST(TwistHistory, ATwistThatLacksTheForwardVelocityIsLeftOut) {
  TwistHistory history;
  StampedTwist twist{10.0, {4.0, 0.0, 0.0}, {0.0, 0.0, 0.1}};
  EXPECT_FALSE(history.add(twist).any());
  twist.time = 10.1;
  twist.covariance(5, 5) = 1e6;
  EXPECT_TRUE(history.add(twist, /*needs_yaw_rate=*/true).yaw_rate);
  EXPECT_EQ(history.latest()->time, 10.0);
  EXPECT_FALSE(history.add(twist, false).any());
  EXPECT_EQ(history.latest()->time, 10.1);
  twist.time = 10.2;
  twist.covariance(0, 0) = 1e6;
  EXPECT_TRUE(history.add(twist).forward);
  EXPECT_EQ(history.latest()->time, 10.1);
}

// Only a vertical motion has a likely value where it is not observed.
TEST(OnWheels, UnobservedVerticalMotionIsZero) {
  const auto components = [](const StampedTwist& twist) {
    Eigen::Matrix<double, 6, 1> all;
    all << twist.linear, twist.angular;
    return all;
  };
  const StampedTwist observed{12.5, {1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  EXPECT_EQ(components(onWheels(observed)), components(observed));
  for (Eigen::Index i = 0; i < 6; ++i) {
    StampedTwist twist = observed;
    twist.covariance(i, i) = 1e6;
    Eigen::Matrix<double, 6, 1> expected = components(observed);
    if (i >= 2 && i <= 4) expected(i) = 0.0;
    EXPECT_EQ(components(onWheels(twist)), expected) << "component " << i;
    twist.covariance(i, i) = 100.0;
    EXPECT_EQ(components(onWheels(twist)), components(observed)) << "known badly is not unknown, " << i;
  }
}

}  // namespace
}  // namespace radar_dot
