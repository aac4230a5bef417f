// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

constexpr double kPeriod = 0.075;  // s

/// The filtered estimate after a drive of so many sweeps. @param turned  rad, of the first radar's mount
EgoVelocityResult drive(SweepEstimator& estimator, double begin, int sweeps, double turned = 0.0) {
  EgoVelocityResult latest;
  for (int i = 0; i < sweeps; ++i) {
    test::SweepOptions options;
    options.seed = static_cast<std::uint32_t>(i + 1);
    options.doppler_sigma = 0.05;
    const test::Sweep sweep = test::makeSweep(test::carMounts(), {10.0, 0.0, 0.0}, {0.0, 0.0, 0.05}, options);
    std::vector<RadarScan> scans = sweep.scans();
    const double time = begin + kPeriod * i;
    for (RadarScan& scan : scans) scan.time = time;
    scans[0].T_base_from_sensor.linear() =
        Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) * scans[0].T_base_from_sensor.linear();
    const SweepEstimate estimate = estimator.estimate(scans, time);
    EXPECT_TRUE(estimate.single.valid()) << estimate.single.reason;
    EXPECT_TRUE(estimate.filtered) << i;
    if (!estimate.filtered) continue;
    EXPECT_FALSE(estimate.filtered->was_reset) << i;
    latest = filteredResult(estimate.filtered->state, estimate.single);
  }
  return latest;
}

SweepEstimatorParams mountsToLearn() {
  SweepEstimatorParams config;
  config.filter_params.lateral_slip_std = 0.01;
  config.filter_params.mount_yaw_std = 0.02;
  return config;
}

TEST(SweepEstimator, OtherParametersKeepWhatTheFilterHasLearnt) {
  SweepEstimator estimator;
  SweepEstimatorParams config = mountsToLearn();
  estimator.configure(config);
  const EgoVelocityResult before = drive(estimator, 0.0, 40, -0.02);
  const double learnt = estimator.filter().mountYaw(0);
  EXPECT_GT(std::abs(learnt), 0.005) << "there is something to lose";

  config.estimator.inlier_threshold = 0.25;
  config.bearing_delay = 0.01;
  estimator.configure(config);
  EXPECT_TRUE(estimator.filter().started());
  EXPECT_EQ(estimator.filter().mountYaw(0), learnt);
  EXPECT_EQ(estimator.params().inlier_threshold, 0.25);
  const EgoVelocityResult after = drive(estimator, 40 * kPeriod, 1, -0.02);
  EXPECT_NEAR(after.linear.x(), before.linear.x(), 0.05);
  EXPECT_LT(after.covariance(0, 0), 1.5 * before.covariance(0, 0)) << "a filter that starts is less certain";
}

TEST(SweepEstimator, AParameterOfTheFilterStartsItAgain) {
  SweepEstimator estimator;
  SweepEstimatorParams config = mountsToLearn();
  estimator.configure(config);
  drive(estimator, 0.0, 10);
  ASSERT_TRUE(estimator.filter().started());
  config.filter_params.lateral_jerk = 0.5;
  estimator.configure(config);
  EXPECT_FALSE(estimator.filter().started());
  EXPECT_EQ(estimator.filter().params().lateral_jerk, 0.5);
}

TEST(SweepEstimator, WhatCannotBeConfiguredChangesNothing) {
  SweepEstimator estimator;
  SweepEstimatorParams config = mountsToLearn();
  estimator.configure(config);
  drive(estimator, 0.0, 10);
  SweepEstimatorParams wrong = config;
  wrong.estimator.inlier_threshold = 0.2;
  wrong.filter_params.lateral_slip_std = -1.0;
  EXPECT_THROW(estimator.configure(wrong), InvalidParameter);
  EXPECT_EQ(estimator.params().inlier_threshold, config.estimator.inlier_threshold);
  EXPECT_TRUE(estimator.filter().started());
}

TEST(SweepEstimator, TheOutputIsFilteredOrThatOfTheSweepAlone) {
  const test::Sweep sweep = test::makeSweep(test::carMounts(), {10.0, 0.0, 0.0}, {0.0, 0.0, 0.05}, {});
  for (const bool filter : {true, false}) {
    SweepEstimatorParams config;
    config.filter = filter;
    SweepEstimator estimator(config);
    std::vector<RadarScan> scans = sweep.scans(), none;
    EXPECT_FALSE(estimator.estimate(none, 0.0).output());
    estimator.estimate(scans, kPeriod);  // the filter starts with it as it is
    const SweepEstimate estimate = estimator.estimate(scans, 2.0 * kPeriod);
    const std::optional<EgoVelocityResult> output = estimate.output();
    ASSERT_TRUE(output);
    EXPECT_EQ(estimate.filtered.has_value(), filter);
    EXPECT_EQ(output->covariance == estimate.single.covariance, !filter);
    EXPECT_EQ(estimator.estimate(scans, 2.0 * kPeriod).output().has_value(), !filter)
        << "not later than before";
  }
}

/// The output after a drive of 3 s with radars on `mounts`.
EgoVelocityResult outputOf(MotionModel model, const std::vector<Eigen::Isometry3d>& mounts,
                           const Eigen::Vector3d& velocity, const Eigen::Vector3d& angular,
                           const std::optional<AngularVelocity>& known = std::nullopt) {
  SweepEstimatorParams config;
  config.estimator.model = model;
  config.filter_params.mount_yaw_std = 0.0;
  SweepEstimator estimator(config);
  SweepEstimate estimate;
  for (int i = 0; i < 40; ++i) {
    test::SweepOptions options;
    options.seed = static_cast<std::uint32_t>(i + 1);
    options.doppler_sigma = 0.05;
    std::vector<RadarScan> scans;
    const test::Sweep sweep = test::makeSweep(mounts, velocity, angular, options);
    scans = sweep.scans();
    for (RadarScan& scan : scans) scan.time = kPeriod * i;
    estimate = estimator.estimate(scans, kPeriod * i, known);
    if (!estimate.filtered) continue;
    EXPECT_NE(estimate.filtered->outcome, VelocityFilter::Outcome::kRejected) << toString(model) << i;
    EXPECT_FALSE(estimate.filtered->was_reset) << toString(model) << i;
  }
  EXPECT_EQ(estimate.filtered.has_value(), model != MotionModel::kSpatial);
  EXPECT_TRUE(estimate.output()) << toString(model);
  return estimate.output().value_or(EgoVelocityResult());
}

// A curve of 0.3 rad/s; what the model assumes is in the output as the model says it.
TEST(SweepEstimator, TheFilterHonoursTheModel) {
  const Eigen::Vector3d v(8.0, 0.0, 0.0), w(0.0, 0.0, 0.3);
  const std::vector<Eigen::Isometry3d> front = {test::mount(3.4, 0.0, 0.5, 0.0)};
  for (const auto& mounts : {front, test::carMounts()}) {
    const EgoVelocityResult ackermann = outputOf(MotionModel::kAckermann, mounts, v, w);
    EXPECT_NEAR(ackermann.linear.x(), 8.0, 0.05);
    EXPECT_EQ(ackermann.linear.y(), 0.0);
    EXPECT_DOUBLE_EQ(ackermann.covariance(1, 1), 0.01) << "sideslip_std";
    EXPECT_NEAR(ackermann.angular.z(), 0.3, 0.02);
    EXPECT_TRUE(ackermann.observed[5] && ackermann.fully_observed);
    EXPECT_FALSE(ackermann.observed[1]);

    const EgoVelocityResult planar = outputOf(MotionModel::kPlanar, mounts, v, w);
    EXPECT_NEAR(planar.linear.x(), 8.0, 0.2);
    EXPECT_EQ(planar.angular.z(), 0.0);
    EXPECT_FALSE(planar.observed[5]);
    EXPECT_GE(planar.covariance(5, 5), 0.99e6);
  }
}

TEST(SweepEstimator, AKnownAngularVelocityMakesOneRadarEnough) {
  const Eigen::Vector3d v(8.0, 0.2, 0.0), w(0.3, -0.2, 0.3);
  const AngularVelocity known{w, 1e-4 * Eigen::Matrix3d::Identity()};
  const std::vector<Eigen::Isometry3d> high = {test::mount(3.4, 0.5, 1.5, 0.3)};
  for (const MotionModel model : {MotionModel::kPlanar, MotionModel::kPlanarYaw}) {
    const EgoVelocityResult output = outputOf(model, high, v, w, known);
    EXPECT_LT((output.linear - v).norm(), 0.06) << toString(model);
    EXPECT_LT((output.angular - w).norm(), 0.005) << toString(model);
    EXPECT_TRUE(output.observed[1] && output.observed[5] && output.fully_observed) << toString(model);
    EXPECT_LT(output.covariance(1, 1), 0.01) << toString(model);
    EXPECT_EQ(output.covariance(3, 3), 1e-4);
  }
}

// The filter is that of a vehicle in the plane.
TEST(SweepEstimator, TheSpatialModelIsNotFiltered) {
  const EgoVelocityResult output =
      outputOf(MotionModel::kSpatial, test::carMounts(), {8.0, 0.2, 0.0}, {0.0, 0.0, 0.3});
  EXPECT_NEAR(output.angular.z(), 0.3, 0.02);
  EXPECT_FALSE(output.residuals.empty());
}

// The filter weighs each radar by the configured noise, not by its default.
TEST(SweepEstimator, ALargerDopplerStdWidensTheFilteredCovariance) {
  const auto filtered = [](double doppler_std) {
    SweepEstimator estimator;
    SweepEstimatorParams config;
    config.estimator.noise.doppler_std = doppler_std;
    estimator.configure(config);
    return drive(estimator, 0.0, 20);
  };
  const EgoVelocityResult usual = filtered(0.12), noisy = filtered(0.48);
  EXPECT_GT(noisy.covariance(0, 0), 2.0 * usual.covariance(0, 0));
  EXPECT_GT(noisy.covariance(1, 1), 2.0 * usual.covariance(1, 1));
  EXPECT_NEAR(noisy.linear.x(), 10.0, 0.1);
}

TEST(SweepEstimator, ParametersOfTheSingleRadarsArrive) {
  SweepEstimator estimator;
  SweepEstimatorParams config;
  config.estimator.sensor.min_sensor_returns = 7;
  config.estimator.sensor.sensor_scan_std = 0.05;
  estimator.configure(config);
  EXPECT_EQ(estimator.params().sensor.min_sensor_returns, 7);
  EXPECT_EQ(estimator.params().sensor.sensor_scan_std, 0.05);
}

TEST(SweepEstimator, BearingsTurnWithTheLatestYawRate) {
  SweepEstimator estimator;
  SweepEstimatorParams config;
  config.bearing_delay = 0.04;
  estimator.configure(config);
  const auto rotation = [&estimator](double time) {
    std::vector<RadarScan> scans(1);
    scans[0].time = time;
    scans[0].bearing_rotation = 7.0;
    estimator.turnBearings(scans);
    return scans[0].bearing_rotation;
  };
  EXPECT_EQ(rotation(0.0), 0.0) << "nothing is known yet";
  drive(estimator, 0.0, 1);
  EXPECT_NEAR(rotation(kPeriod), 0.04 * 0.05, 5e-4);
  EXPECT_EQ(rotation(5.0), 0.0) << "too long ago";
  estimator.reset();
  EXPECT_EQ(rotation(kPeriod), 0.0);
}

}  // namespace
}  // namespace radar_dot
