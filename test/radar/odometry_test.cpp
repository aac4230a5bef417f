// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/odometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "radar_dot/common/pose_buffer.h"

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

/// A drive with an IMU at 100 Hz and velocities at 13 Hz.
struct ImuDrive {
  std::function<double(double)> speed, yaw, pitch;  // m/s and rad (nose down positive), of s
  double duration = 60.0;                           // s
  double gyro_noise = 0.0, gyro_bias = 0.0;         // rad/s
  double force_noise = 0.0, speed_noise = 0.0;      // m/s^2, m/s

  Eigen::Quaterniond rotation(double time) const {
    return Eigen::AngleAxisd(yaw(time), Vector3d::UnitZ()) *
           Eigen::AngleAxisd(pitch(time), Vector3d::UnitY());
  }
  Vector3d velocity(double time) const { return rotation(time) * Vector3d(speed(time), 0.0, 0.0); }

  struct Result {
    Vector3d truth = Vector3d::Zero(), odometry = Vector3d::Zero();
    double distance = 0.0;
  };
  /// @param with_force  false: the accelerometer is not connected
  Result drive(bool with_force) const {
    constexpr double kStep = 0.01;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) -> Vector3d {
      return sigma * Vector3d(normal(random), normal(random), normal(random));
    };
    AttitudeIntegrator attitude;
    VelocityIntegrator integrator;
    Result result;
    for (int i = 0; i * kStep <= duration; ++i) {
      const double time = i * kStep;
      const Eigen::AngleAxisd turn(rotation(time - 1e-4).conjugate() * rotation(time + 1e-4));
      const Vector3d rate = turn.angle() / 2e-4 * turn.axis();
      const Vector3d force = rotation(time).conjugate() *
                             ((velocity(time + 1e-4) - velocity(time - 1e-4)) / 2e-4 + Vector3d(0, 0, 9.81));
      const Vector3d measured = force + noise(force_noise);
      attitude.add(time, rate + noise(gyro_noise) + Vector3d::Constant(gyro_bias),
                   with_force ? measured : Vector3d::Zero());
      if (i > 0) result.truth += 0.5 * kStep * (velocity(time - kStep) + velocity(time));
      if (i % 8 != 0) continue;
      const Vector3d measured_velocity(speed(time) + speed_noise * normal(random), 0.0, 0.0);
      attitude.level(time, measured_velocity);
      integrator.add({time, measured_velocity}, attitude.attitude());
    }
    result.odometry = integrator.state().T_odom_from_base.translation();
    result.distance = integrator.state().distance;
    return result;
  }
};

double townSpeed(double time) { return 7.0 - 7.0 * std::cos(0.4 * time); }  // m/s, 2.8 m/s^2 at most
double townYaw(double time) { return 1.2 * std::sin(0.25 * time); }         // rad

// A climb is the sine of the pitch times the way, also where the speed changes on it.
TEST(Odometry, ClimbsAHillByTheImu) {
  ImuDrive hill;
  hill.speed = townSpeed;
  hill.yaw = townYaw;
  constexpr double kSlope = 0.1;  // rad
  hill.pitch = [](double time) { return -kSlope * std::clamp(time - 10.0, 0.0, 1.0); };
  const ImuDrive::Result result = hill.drive(true);
  const double before = 7.0 * 10.5 - 17.5 * std::sin(0.4 * 10.5);  // m, up to the middle of the bend
  EXPECT_NEAR(result.odometry.z(), std::sin(kSlope) * (result.distance - before), 0.4);
  EXPECT_NEAR((result.odometry - result.truth).norm(), 0.0, 0.5) << result.odometry.transpose();
}

// On the plane an IMU with noise and a bias of 0.1 degrees/s does no worse than its yaw rate alone.
TEST(Odometry, StaysOnThePlaneWithANoisyImu) {
  ImuDrive town;
  town.speed = townSpeed;
  town.yaw = townYaw;
  town.pitch = [](double) { return 0.0; };
  town.duration = 120.0;
  town.gyro_noise = 0.005;
  town.gyro_bias = 0.002;
  town.force_noise = 0.3;
  town.speed_noise = 0.03;
  const ImuDrive::Result full = town.drive(true), flat = town.drive(false);
  EXPECT_LT(std::abs(full.odometry.z()), 0.004 * full.distance);
  const double error = (full.odometry - full.truth).head<2>().norm();
  EXPECT_LT(error, (flat.odometry - flat.truth).head<2>().norm() + 0.001 * full.distance);
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
