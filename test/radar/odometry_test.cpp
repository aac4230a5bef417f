// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

namespace radar_dot {
namespace {

using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

double yawOf(const Eigen::Isometry3d& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

TEST(VelocityIntegrator, StraightLine) {
  VelocityIntegrator integrator;
  for (int i = 0; i <= 100; ++i) {
    ASSERT_TRUE(integrator.add({0.1 * i, {5.0, 0.0, 0.0}}));
  }
  EXPECT_NEAR(integrator.state().T_odom_from_base.translation().x(), 50.0, 1e-9);
  EXPECT_NEAR(integrator.state().distance, 50.0, 1e-9);
}

// A circle of radius v / w closes after 2 pi / w.
TEST(VelocityIntegrator, CircleClosesOnItself) {
  VelocityIntegrator integrator;
  const double w = 0.5;
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i) {
    integrator.add({2.0 * M_PI / w * i / kSteps, {5.0, 0.0, 0.0}, {0.0, 0.0, w}});
    if (i == kSteps / 4) {
      EXPECT_NEAR(integrator.state().T_odom_from_base.translation().x(), 10.0, 1e-2);
      EXPECT_NEAR(integrator.state().T_odom_from_base.translation().y(), 10.0, 1e-2);
      EXPECT_NEAR(yawOf(integrator.state().T_odom_from_base), M_PI / 2, 1e-9);
    }
  }
  EXPECT_LT(integrator.state().T_odom_from_base.translation().norm(), 1e-2);
}

// The paper's integration: heading from outside, translation from the radar.
TEST(VelocityIntegrator, FollowsAGivenHeading) {
  VelocityIntegrator integrator;
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation() = Vector3d(10.0, 20.0, 0.0);
  integrator.reset(start);
  const Eigen::Quaterniond north(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));
  for (int i = 0; i <= 10; ++i) integrator.add({1.0 * i, {2.0, 0.0, 0.0}, {0.0, 0.0, 9.9}}, north);
  EXPECT_NEAR(integrator.state().T_odom_from_base.translation().x(), 10.0, 1e-9);
  EXPECT_NEAR(integrator.state().T_odom_from_base.translation().y(), 40.0, 1e-9);
  EXPECT_NEAR(yawOf(integrator.state().T_odom_from_base), M_PI / 2, 1e-9);
}

TEST(VelocityIntegrator, SidewaysVelocityMovesSideways) {
  VelocityIntegrator integrator;
  integrator.add({0.0, {0.0, 1.0, 0.0}});
  integrator.add({2.0, {0.0, 1.0, 0.0}});
  EXPECT_NEAR(integrator.state().T_odom_from_base.translation().y(), 2.0, 1e-12);
}

TEST(VelocityIntegrator, RefusesTimeThatDoesNotAdvance) {
  VelocityIntegrator integrator;
  EXPECT_TRUE(integrator.add({1.0, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(integrator.add({1.0, {1.0, 0.0, 0.0}}));
  EXPECT_FALSE(integrator.add({0.5, {1.0, 0.0, 0.0}}));
  EXPECT_EQ(integrator.state().distance, 0.0);
  const double nan = std::nan("");
  EXPECT_FALSE(integrator.add({2.0, {nan, 0.0, 0.0}}));
  EXPECT_FALSE(integrator.add({nan, {1.0, 0.0, 0.0}}));
  EXPECT_TRUE(integrator.add({2.0, {1.0, 0.0, 0.0}})) << "nothing was spoilt";
  integrator.reset();
  EXPECT_TRUE(integrator.add({0.5, {1.0, 0.0, 0.0}}));
}

// n independent steps of variance s^2 dt^2 add up; a heading error swings the way travelled.
TEST(VelocityIntegrator, CovarianceGrowsAsTheStepsAddUp) {
  VelocityIntegrator integrator;
  Matrix6d covariance = Matrix6d::Zero();
  covariance(0, 0) = 0.04;
  for (int i = 0; i <= 50; ++i) integrator.add({0.1 * i, {5.0, 0.0, 0.0}, Vector3d::Zero(), covariance});
  EXPECT_NEAR(integrator.state().covariance(0, 0), 50 * 0.04 * 0.01, 1e-12);
  EXPECT_NEAR(integrator.state().covariance(1, 1), 0.0, 1e-12);

  integrator.reset();
  covariance.setZero();
  covariance(5, 5) = 0.01;
  for (int i = 0; i <= 50; ++i) integrator.add({0.1 * i, {5.0, 0.0, 0.0}, Vector3d::Zero(), covariance});
  double lateral = 0.0;  // sum over steps of (remaining way after the step)^2 times the step's variance
  for (int i = 0; i < 50; ++i) lateral += std::pow(0.5 * i, 2) * 0.01 * 0.01;
  EXPECT_NEAR(integrator.state().covariance(1, 1), lateral, 1e-9);
  EXPECT_NEAR(integrator.state().covariance(5, 5), 50 * 0.01 * 0.01, 1e-12);
}

TEST(AccelerationTracker, FindsTheSlope) {
  AccelerationTracker tracker(0.5);
  EXPECT_EQ(tracker.acceleration(0.0), Vector3d::Zero());
  for (int i = 0; i < 20; ++i) tracker.add(0.07 * i, Vector3d(5.0 - 3.0 * 0.07 * i, 0.2, 0.0));
  EXPECT_NEAR(tracker.acceleration(1.4).x(), -3.0, 1e-9);
  EXPECT_NEAR(tracker.acceleration(1.4).y(), 0.0, 1e-9);
  EXPECT_EQ(tracker.acceleration(5.0), Vector3d::Zero()) << "old history says nothing";
  tracker.add(0.1, {1.0, 0.0, 0.0});  // a bag that starts over
  EXPECT_EQ(tracker.acceleration(0.1), Vector3d::Zero());
}

}  // namespace
}  // namespace radar_dot
