// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/velocity_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Outcome = VelocityFilter::Outcome;

constexpr double kPeriod = 1.0 / 13.0;  // s, of the sweeps

/// Nothing but the motion: no slip, exact mounts, errors independent.
VelocityFilterParams plain() {
  VelocityFilterParams params;
  params.lateral_slip_std = 0.0;
  params.mount_yaw_std = 0.0;
  params.error_correlation_time = 0.0;
  return params;
}

Matrix3d noiseOf(double linear_std, double yaw_std) {
  return Vector3d(linear_std * linear_std, linear_std * linear_std, yaw_std * yaw_std).asDiagonal();
}

class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed) {}
  double operator()(double std) { return std * normal_(random_); }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

/// The velocities over ground of the five radars of a car whose mounts are turned by `yaw`.
std::vector<SensorVelocity> sensorsOf(const Vector3d& velocity, double time, const std::vector<double>& yaw,
                                      Noise& noise, double std) {
  std::vector<SensorVelocity> sensors;
  const std::vector<Eigen::Isometry3d> mounts = test::carMounts();
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    SensorVelocity sensor;
    sensor.radar = i;
    sensor.time = time;
    sensor.lever_arm = mounts[i].translation().head<2>();
    const Eigen::Vector2d over_ground(velocity.x() - velocity.z() * sensor.lever_arm.y(),
                                      velocity.y() + velocity.z() * sensor.lever_arm.x());
    sensor.velocity = Eigen::Rotation2Dd(-yaw[i]) * over_ground + Eigen::Vector2d(noise(std), noise(std));
    sensor.covariance = std * std * Eigen::Matrix2d::Identity();
    sensors.push_back(sensor);
  }
  return sensors;
}

TEST(VelocityFilter, TracksAConstantAccelerationWithoutBias) {
  VelocityFilter filter(plain());
  const auto truth = [](double t) { return Vector3d(5.0 + 2.0 * t, 0.1 * t, 0.0); };
  for (int i = 0; i < 130; ++i) filter.update(i * kPeriod, truth(i * kPeriod), noiseOf(0.05, 0.01));
  const VelocityFilter::State state = filter.at(filter.time());
  EXPECT_LT((state.velocity - truth(state.time)).norm(), 1e-3);
  EXPECT_NEAR(state.acceleration.x(), 2.0, 1e-2);
  // And ahead of the latest update.
  EXPECT_NEAR(filter.at(state.time + 0.2).velocity.x(), truth(state.time + 0.2).x(), 5e-3);
  EXPECT_GT(filter.at(state.time + 0.2).covariance(0, 0), state.covariance(0, 0));
}

// The steady state of the discrete Riccati equation, iterated on the 2 x 2 problem of vx alone.
TEST(VelocityFilter, ReducesWhiteNoiseAsTheSteadyStateGainSays) {
  const VelocityFilterParams params = plain();
  const double r = 0.05 * 0.05;
  const double q = params.longitudinal_jerk * params.longitudinal_jerk;
  const double dt = kPeriod;
  Eigen::Matrix2d F, Q;
  F << 1.0, dt, 0.0, 1.0;
  Q << q * dt * dt * dt / 3.0, q * dt * dt / 2.0, q * dt * dt / 2.0, q * dt;
  Eigen::Matrix2d P = Eigen::Matrix2d::Identity();
  Eigen::Vector2d gain;
  for (int i = 0; i < 1000; ++i) {
    P = F * P * F.transpose() + Q;
    gain = P.col(0) / (P(0, 0) + r);
    P -= gain * P.row(0);
  }
  // Variance of the error that the measurement noise alone leaves, with this gain.
  const Eigen::Matrix2d closed = (Eigen::Matrix2d::Identity() - gain * Eigen::RowVector2d(1.0, 0.0)) * F;
  Eigen::Matrix2d expected = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 1000; ++i)
    expected = closed * expected * closed.transpose() + r * gain * gain.transpose();

  VelocityFilter filter(params);
  Noise noise(1);
  double sum = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    filter.update(i * dt, Vector3d(8.0 + noise(0.05), noise(0.05), noise(0.01)), noiseOf(0.05, 0.01));
    if (i >= 100) sum += std::pow(filter.state()[0] - 8.0, 2);
  }
  EXPECT_NEAR(filter.covariance()(0, 0), P(0, 0), 1e-6);
  EXPECT_NEAR(sum / (kSteps - 100), expected(0, 0), 0.1 * expected(0, 0));
  EXPECT_LT(expected(0, 0), 0.6 * r);
}

// Normalised squared error of motions drawn from the filter's own model: chi-square with three degrees of
// freedom, 100 independent runs.
TEST(VelocityFilter, CovarianceIsConsistent) {
  const VelocityFilterParams params = plain();
  double sum = 0.0;
  constexpr int kRuns = 100;
  constexpr int kFine = 20;  // steps of the simulated motion per sweep
  for (std::uint32_t run = 0; run < kRuns; ++run) {
    Noise noise(run + 1);
    VelocityFilter filter(params);
    Eigen::Matrix<double, 6, 1> x;
    x << 8.0, 0.0, 0.0, noise(1.0), noise(0.2), noise(0.03);
    const double dt = kPeriod / kFine;
    for (int i = 0; i < 60 * kFine; ++i) {
      if (i % kFine == 0) {
        filter.update(i * dt, x.head<3>() + Vector3d(noise(0.05), noise(0.05), noise(0.01)),
                      noiseOf(0.05, 0.01));
        if (i == 59 * kFine) break;
      }
      x.head<3>() += dt * x.tail<3>();
      x[3] += noise(params.longitudinal_jerk * std::sqrt(dt));
      x[4] += noise(params.lateral_jerk * std::sqrt(dt));
      const double yaw = std::min(params.curvature_rate * std::abs(x[0]), params.yaw_jerk / std::abs(x[0]));
      const double kept = std::exp(-dt / params.yaw_acceleration_time);
      x[5] = kept * x[5] + noise(yaw * std::sqrt(1.0 - kept * kept));
    }
    const Vector3d error = filter.state().head<3>() - x.head<3>();
    const Matrix3d P = filter.covariance().topLeftCorner<3, 3>();
    sum += error.dot(P.ldlt().solve(error));
  }
  // 300 degrees of freedom: 99 % within 239 ... 366.
  EXPECT_GT(sum, 239.0);
  EXPECT_LT(sum, 366.0);
}

TEST(VelocityFilter, AnOutlierIsRejected) {
  VelocityFilter filter(plain());
  for (int i = 0; i < 50; ++i)
    ASSERT_NE(filter.update(i * kPeriod, {8.0, 0.0, 0.1}, noiseOf(0.05, 0.01)), Outcome::kRejected);
  EXPECT_EQ(filter.update(50 * kPeriod, {3.0, -2.0, 0.5}, noiseOf(0.05, 0.01)), Outcome::kRejected);
  EXPECT_LT((filter.at(50 * kPeriod).velocity - Vector3d(8.0, 0.0, 0.1)).norm(), 0.01);
  EXPECT_EQ(filter.update(51 * kPeriod, {8.0, 0.0, 0.1}, noiseOf(0.05, 0.01)), Outcome::kUpdated);
}

TEST(VelocityFilter, RecoversFromATrueJump) {
  const VelocityFilterParams params = plain();
  VelocityFilter filter(params);
  for (int i = 0; i < 50; ++i) filter.update(i * kPeriod, {8.0, 0.0, 0.1}, noiseOf(0.05, 0.01));
  for (int i = 0; i < params.max_rejected; ++i) {
    EXPECT_EQ(filter.update((50 + i) * kPeriod, {-3.0, 0.0, 0.0}, noiseOf(0.05, 0.01)),
              i + 1 < params.max_rejected ? Outcome::kRejected : Outcome::kStarted);
  }
  EXPECT_LT((filter.at(filter.time()).velocity - Vector3d(-3.0, 0.0, 0.0)).norm(), 1e-9);
}

// From one sweep to the next, as in an emergency.
TEST(VelocityFilter, FollowsABrakingThatStartsAtOnce) {
  VelocityFilter filter;
  Noise noise(4);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double time = i * kPeriod;
    const double speed = std::max(0.0, 20.0 - 8.0 * std::max(0.0, time - 2.0));
    const Outcome outcome =
        filter.update(time, {speed + noise(0.06), noise(0.05), noise(0.01)}, noiseOf(0.06, 0.01));
    EXPECT_TRUE(i == 0 || outcome != Outcome::kStarted) << "at " << time << " s";
    worst = std::max(worst, std::abs(filter.at(time).velocity.x() - speed));
  }
  EXPECT_LT(worst, 0.9) << "about the change of one sweep";
}

TEST(VelocityFilter, StartsAnewAfterAGap) {
  VelocityFilter filter(plain());
  filter.update(0.0, {8.0, 0.0, 0.0}, noiseOf(0.05, 0.01));
  filter.update(0.1, {8.1, 0.0, 0.0}, noiseOf(0.05, 0.01));
  EXPECT_EQ(filter.update(0.9, {8.5, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kUpdated);
  EXPECT_EQ(filter.update(60.0, {2.0, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStarted);
  EXPECT_DOUBLE_EQ(filter.at(60.0).velocity.x(), 2.0);
}

TEST(VelocityFilter, StampsThatDoNotRiseChangeNothing) {
  VelocityFilter filter(plain());
  filter.update(5.0, {8.0, 0.0, 0.0}, noiseOf(0.05, 0.01));
  filter.update(5.1, {8.0, 0.0, 0.0}, noiseOf(0.05, 0.01));
  const Eigen::VectorXd state = filter.state();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(filter.update(5.1, {9.0, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStale) << "a duplicate";
  EXPECT_EQ(filter.update(5.05, {9.0, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStale) << "out of order";
  EXPECT_EQ(filter.update(nan, {9.0, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStale);
  EXPECT_EQ(filter.update(5.2, {nan, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStale);
  EXPECT_EQ(filter.state(), state);
  filter.reset();
  EXPECT_EQ(filter.update(1.0, {9.0, 0.0, 0.0}, noiseOf(0.05, 0.01)), Outcome::kStarted) << "after a reset";
}

TEST(VelocityFilter, StandingAndReversing) {
  VelocityFilter filter{VelocityFilterParams()};
  Noise noise(3);
  const std::vector<double> exact(5, 0.0);
  for (int i = 0; i < 260; ++i) {
    const double t = i * kPeriod;
    const double speed = t < 5.0 ? 0.0 : std::max(-3.0, -(t - 5.0));
    const Vector3d truth(speed, 0.0, -0.1 * speed);
    const Outcome outcome =
        filter.update(t, truth, noiseOf(0.05, 0.02), sensorsOf(truth, t, exact, noise, 0.03));
    EXPECT_NE(outcome, Outcome::kRejected) << "at " << t << " s";
    if (i > 13) {
      EXPECT_LT((filter.at(t).velocity - truth).norm(), 0.15) << "at " << t << " s";
    }
  }
  EXPECT_LT((filter.state().head<3>() - Vector3d(-3.0, 0.0, 0.3)).norm(), 0.05);
}

// Mounts turned against each other show; with a rear axle that does not slip, so does what they share.
TEST(VelocityFilter, LearnsTheMounts) {
  VelocityFilterParams params;
  params.lateral_slip_std = 0.002;
  params.mount_yaw_std = 0.02;
  VelocityFilter filter(params);
  Noise noise(4);
  const std::vector<double> yaw = {0.010, -0.015, 0.0, 0.012, -0.010};
  for (int i = 0; i < 1300; ++i) {
    const double t = i * kPeriod;
    const Vector3d truth(10.0, 0.0, 0.1 * std::sin(0.3 * t));
    filter.update(t, truth, noiseOf(0.05, 0.02), sensorsOf(truth, t, yaw, noise, 0.05));
  }
  for (std::size_t i = 0; i < yaw.size(); ++i) {
    EXPECT_NEAR(filter.mountYaw(i), yaw[i], 4.0 * std::sqrt(filter.mountYawVariance(i))) << "radar " << i;
    EXPECT_LT(filter.mountYawVariance(i), 0.25 * 0.02 * 0.02) << "radar " << i;
  }
  EXPECT_NEAR(filter.mountYaw(0) - filter.mountYaw(1), yaw[0] - yaw[1], 0.003);
  EXPECT_EQ(filter.mountYaw(77), 0.0);
  EXPECT_EQ(filter.mountYawVariance(77), 0.02 * 0.02);
}

/// State after a drive at constant velocity, seen by the radar in front alone (at 3.4 m), whose joint
/// estimate is `velocity` with `covariance`.
VelocityFilter::State drivenByFrontRadar(const Vector3d& truth, const Vector3d& velocity,
                                         const Matrix3d& covariance, const VelocityFilter::Sources& sources,
                                         bool by_radar) {
  VelocityFilter filter(plain());
  Noise noise(8);
  for (int i = 0; i < 100; ++i) {
    std::vector<SensorVelocity> sensors;
    if (by_radar) sensors = {sensorsOf(truth, i * kPeriod, std::vector<double>(5, 0.0), noise, 0.03)[0]};
    EXPECT_NE(filter.update(i * kPeriod, velocity, covariance, sensors, sources), Outcome::kRejected);
  }
  return filter.at(filter.time());
}

// The model says vy = 0 within 0.1 m/s. What the car slips passes for a yaw rate, by 0.1 / 3.4 rad/s, which
// the filter cannot know, but says.
TEST(VelocityFilter, WhatTheModelAssumesStaysSo) {
  constexpr double kSlip = 0.1, kLever = 3.4;
  Matrix3d covariance = noiseOf(0.03, 0.01);
  covariance(1, 1) = kSlip * kSlip;
  covariance(2, 2) += kSlip * kSlip / (kLever * kLever);
  covariance(1, 2) = covariance(2, 1) = -kSlip * kSlip / kLever;
  const Vector3d truth(10.0, kSlip, 0.1);
  const Vector3d joint(10.0, 0.0, 0.1 + kSlip / kLever);
  for (const bool by_radar : {true, false}) {
    const VelocityFilter::State state =
        drivenByFrontRadar(truth, joint, covariance,
                           {AxisSource::kEstimated, AxisSource::kAssumed, AxisSource::kEstimated}, by_radar);
    EXPECT_EQ(state.velocity.y(), 0.0);
    EXPECT_DOUBLE_EQ(state.covariance(1, 1), kSlip * kSlip);
    EXPECT_NEAR(state.velocity.z(), joint.z(), 0.01);
    EXPECT_NEAR(std::sqrt(state.covariance(2, 2)), kSlip / kLever, 0.004);
    EXPECT_NEAR(state.covariance(1, 2), -kSlip * kSlip / kLever, 1e-4);
  }
}

// What one radar sees sideways is vy + 3.4 w; with w given, it is vy.
TEST(VelocityFilter, AGivenYawRateTellsTheSideslip) {
  const Vector3d truth(10.0, 0.3, 0.2);
  const VelocityFilter::State state =
      drivenByFrontRadar(truth, truth, noiseOf(0.03, 0.005),
                         {AxisSource::kEstimated, AxisSource::kEstimated, AxisSource::kGiven}, true);
  EXPECT_LT((state.velocity - truth).norm(), 0.05);
  EXPECT_LT(state.covariance(1, 1), 0.03 * 0.03);
  EXPECT_LT(state.covariance(2, 2), 0.005 * 0.005);
}

// A yaw rate that fits does not keep a filter alive that its radar contradicts.
TEST(VelocityFilter, AGivenYawRateDoesNotHideATrueJump) {
  const VelocityFilterParams params = plain();
  VelocityFilter filter(params);
  Noise noise(9);
  const VelocityFilter::Sources sources = {AxisSource::kEstimated, AxisSource::kEstimated,
                                           AxisSource::kGiven};
  const auto update = [&](int i, double speed) {
    const Vector3d truth(speed, 0.0, 0.1);
    const double time = i * kPeriod;
    return filter.update(time, truth, noiseOf(0.05, 0.01),
                         {sensorsOf(truth, time, std::vector<double>(5, 0.0), noise, 0.03)[0]}, sources);
  };
  for (int i = 0; i < 50; ++i) EXPECT_NE(update(i, 8.0), Outcome::kRejected);
  for (int i = 0; i < params.max_rejected; ++i)
    EXPECT_EQ(update(50 + i, -20.0), i + 1 < params.max_rejected ? Outcome::kRejected : Outcome::kStarted);
}

TEST(VelocityFilter, OtherAssumptionsStartItAnew) {
  VelocityFilter filter(plain());
  VelocityFilter::Sources sources = VelocityFilter::kEstimatedAxes;
  filter.update(0.0, {8.0, 0.3, 0.1}, noiseOf(0.05, 0.01), {}, sources);
  EXPECT_EQ(filter.update(0.1, {8.0, 0.3, 0.1}, noiseOf(0.05, 0.01), {}, sources), Outcome::kUpdated);
  sources[1] = AxisSource::kAssumed;
  EXPECT_EQ(filter.update(0.2, {8.0, 0.0, 0.2}, noiseOf(0.05, 0.01), {}, sources), Outcome::kStarted);
  EXPECT_EQ(filter.state().head<3>(), Vector3d(8.0, 0.0, 0.2));
}

TEST(VelocityFilter, OneBadRadarDoesNotTakeTheOthersWithIt) {
  VelocityFilter filter{VelocityFilterParams()};
  Noise noise(5);
  const Vector3d truth(10.0, 0.0, 0.05);
  for (int i = 0; i < 130; ++i) {
    std::vector<SensorVelocity> sensors =
        sensorsOf(truth, i * kPeriod, std::vector<double>(5, 0.0), noise, 0.04);
    if (i > 65) sensors[2].velocity.x() += 3.0;
    EXPECT_NE(filter.update(i * kPeriod, truth, noiseOf(0.05, 0.02), sensors), Outcome::kRejected);
  }
  EXPECT_LT((filter.state().head<3>() - truth).norm(), 0.1);
}

// A sweep of several radars in a steady turn: their scans lie up to 70 ms apart.
TEST(VelocityFilter, TakesEveryScanAtItsOwnTime) {
  VelocityFilter filter{VelocityFilterParams()};
  Noise noise(6);
  const auto truth = [](double t) { return Vector3d(5.0 + 1.5 * t, 0.0, 0.0); };
  const std::vector<double> exact(5, 0.0);
  for (int i = 1; i < 65; ++i) {
    std::vector<SensorVelocity> sensors;
    for (std::size_t k = 0; k < 5; ++k) {
      const double t = i * kPeriod - 0.014 * static_cast<double>(k);
      sensors.push_back(sensorsOf(truth(t), t, exact, noise, 1e-3)[k]);
    }
    filter.update(i * kPeriod, truth(i * kPeriod), noiseOf(0.05, 0.02), sensors);
  }
  EXPECT_NEAR(filter.state()[0], truth(filter.time()).x(), 0.005);
}

TEST(VelocityFilter, ParametersThatMakeNoSenseAreNamed) {
  const auto refused = [](const std::function<void(VelocityFilterParams&)>& change) {
    VelocityFilterParams params;
    change(params);
    EXPECT_THROW(VelocityFilter{params}, std::invalid_argument);
  };
  refused([](auto& p) { p.longitudinal_jerk = 0.0; });
  refused([](auto& p) { p.max_gap = 0.0; });
}

TEST(FilteredResult, KeepsWhatIsNotFiltered) {
  EgoVelocityResult single;
  single.status = EstimateStatus::kOk;
  single.linear = {8.0, 0.3, 0.2};
  single.sources[0] = single.sources[5] = AxisSource::kEstimated;
  single.covariance = 1e6 * Eigen::Matrix<double, 6, 6>::Identity();
  single.inlier_count = 42;
  VelocityFilter filter(plain());
  filter.update(1.0, {8.1, 0.1, 0.05}, noiseOf(0.05, 0.01));
  const EgoVelocityResult filtered = filteredResult(filter.at(1.0), single);
  EXPECT_TRUE(filtered.valid());
  EXPECT_EQ(filtered.linear, Vector3d(8.1, 0.1, 0.2));
  EXPECT_EQ(filtered.angular, Vector3d(0.0, 0.0, 0.05));
  EXPECT_NEAR(filtered.covariance(0, 0), 0.0025, 1e-12);
  EXPECT_EQ(filtered.covariance(2, 2), 1e6);
  EXPECT_TRUE(filtered.observed[0] && filtered.observed[5]);
  EXPECT_FALSE(filtered.observed[1]) << "assumed";
  EXPECT_FALSE(filtered.observed[2] || filtered.observed[3]);
  EXPECT_EQ(filtered.inlier_count, 42U);
}

}  // namespace
}  // namespace radar_dot
