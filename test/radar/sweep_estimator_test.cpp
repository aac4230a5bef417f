// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

constexpr double kPeriod = 0.075;  // s

/// The filtered estimate after a drive of so many sweeps. @param turned  rad, of the mounts of the first
/// radars
EgoVelocityResult drive(SweepEstimator& estimator, double begin, int sweeps, double turned = 0.0,
                        std::size_t radars = 1) {
  EgoVelocityResult latest;
  for (int i = 0; i < sweeps; ++i) {
    test::SweepOptions options;
    options.seed = static_cast<std::uint32_t>(i + 1);
    options.doppler_sigma = 0.05;
    const test::Sweep sweep = test::makeSweep(test::carMounts(), {10.0, 0.0, 0.0}, {0.0, 0.0, 0.05}, options);
    std::vector<RadarScan> scans = sweep.scans();
    const double time = begin + kPeriod * i;
    for (RadarScan& scan : scans) {
      scan.time = time;
      if (scan.radar >= radars) continue;
      scan.T_base_from_sensor.linear() =
          Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) * scan.T_base_from_sensor.linear();
    }
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

TEST(SweepEstimator, AKnownYawLeavesNoBiasFromTheFirstEstimateOn) {
  // drive() turns the calibration by so much, which turns 10 m/s ahead to 0.1 m/s to the side.
  constexpr double kTurned = -0.01;
  const std::size_t radars = test::carMounts().size();
  SweepEstimatorParams config = mountsToLearn();
  SweepEstimator exact(config), unaware(config), aware(config);
  aware.startFrom(std::vector<std::optional<MountYaw>>(radars, MountYaw{-kTurned, 1e-5}));
  for (const bool again : {false, true}) {
    const Eigen::Vector3d truth = drive(exact, 0.0, 1).linear;
    EXPECT_NEAR((drive(unaware, 0.0, 1, kTurned, radars).linear - truth).y(), -0.1, 0.01);
    EXPECT_LT((drive(aware, 0.0, 1, kTurned, radars).linear - truth).norm(), 1e-6);
    EXPECT_FALSE(aware.hasLearnt(0));

    drive(aware, kPeriod, 40, kTurned, radars);
    EXPECT_NEAR(aware.mountYaw(0).yaw, -kTurned, 3e-3);
    EXPECT_LE(aware.mountYaw(0).std, 1e-3) << "the floor";
    drive(unaware, kPeriod, 40, kTurned, radars);
    EXPECT_TRUE(unaware.hasLearnt(0));
    EXPECT_FALSE(unaware.hasLearnt(99));
    if (again) break;
    aware.reset(), exact.reset(), unaware.reset();
    EXPECT_EQ(aware.mountYaw(0).yaw, -kTurned);
    EXPECT_EQ(aware.mountYaw(0).std, 1e-3);
    EXPECT_EQ(unaware.mountYaw(0).std, config.filter_params.mount_yaw_std);
  }
  config.filter_params.mount_yaw_std = 0.0;
  aware.configure(config);
  EXPECT_EQ(aware.mountYaw(0).yaw, -kTurned) << "other parameters of the filter";
  EXPECT_EQ(aware.mountYaw(0).std, 0.0) << "exact";
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

// A drive whose radars report modulo an interval. What is true comes from the geometry of the sweep, whose
// range rates know no ambiguity.
struct AmbiguousDrive {
  std::vector<Eigen::Isometry3d> mounts = {test::mount(3.4, 0.0, 0.5, 0.0)};
  std::vector<double> unambiguous = {12.8};  // m/s, by radar; those that are not listed have none
  MotionModel model = MotionModel::kPlanarYaw;
  bool filter = true;
  double half_field_of_view = 60.0;  // degrees
  double max_elevation = 0.0;        // degrees
  std::size_t returns_per_radar = 100;
  double yaw_rate = 0.0;  // rad/s

  double time = 0.0;
  SweepEstimator estimator;
  // Of the sweeps so far.
  int sweeps = 0;
  double worst_single = 0.0, worst_output = 0.0;  // m/s, of vx
  std::size_t standing = 0, called_static = 0, unwrapped_wrong = 0;
  std::vector<std::string> refusals, assumptions;

  void configure() {
    SweepEstimatorParams config;
    config.estimator.model = model;
    config.filter = filter;
    estimator.configure(config);
  }

  SweepEstimate sweep(double speed) {
    test::SweepOptions options;
    options.seed = static_cast<std::uint32_t>(++sweeps);
    options.returns_per_radar = returns_per_radar;
    options.moving_share = 0.3;
    options.doppler_sigma = 0.1;
    options.half_field_of_view = half_field_of_view * M_PI / 180.0;
    options.max_elevation = max_elevation * M_PI / 180.0;
    const test::Sweep truth = test::makeSweep(mounts, {speed, 0.0, 0.0}, {0.0, 0.0, yaw_rate}, options);
    test::Sweep seen = truth;
    for (std::size_t r = 0; r < std::min(unambiguous.size(), mounts.size()); ++r) {
      const float v = static_cast<float>(unambiguous[r]);
      for (DopplerReturn& one : seen.returns[r])
        one.doppler -= 2.F * v * std::floor((one.doppler + v) / (2.F * v));
    }
    std::vector<RadarScan> scans = seen.scans();
    for (std::size_t r = 0; r < scans.size(); ++r) {
      scans[r].time = time;
      if (r < unambiguous.size()) scans[r].unambiguous_velocity = unambiguous[r];
    }
    SweepEstimate estimate = estimator.estimate(scans, time);
    if (!estimate.assumption.empty()) assumptions.push_back(estimate.assumption);
    if (!estimate.single.valid()) {
      EXPECT_EQ(scans[0].returns.data(), seen.returns[0].data()) << "what is not known is left as it was";
      refusals.push_back(estimate.single.reason);
      return estimate;
    }
    worst_single = std::max(worst_single, std::abs(estimate.single.linear.x() - speed));
    if (const auto output = estimate.output())
      worst_output = std::max(worst_output, std::abs(output->linear.x() - speed));
    for (std::size_t r = 0; r < scans.size(); ++r) {
      for (std::size_t i = 0; i < scans[r].returns.size(); ++i) {
        if (truth.moving[r][i]) continue;
        ++standing;
        const std::size_t entry = estimate.single.offsets[r] + i;
        called_static += estimate.single.labels[entry] == ReturnLabel::kStatic ? 1 : 0;
        unwrapped_wrong +=
            std::abs(scans[r].returns[i].doppler - truth.returns[r][i].doppler) > 1e-3F ? 1 : 0;
      }
    }
    return estimate;
  }

  /// Drives from one speed to another, by the step of one sweep.
  void ramp(double from, double to, double acceleration = 3.0) {
    const int count = static_cast<int>(std::ceil(std::abs(to - from) / (acceleration * kPeriod)));
    for (int i = 0; i <= count; ++i) {
      sweep(from + (to - from) * i / std::max(1, count));
      time += kPeriod;
    }
  }

  void hold(double speed, int count) {
    for (int i = 0; i < count; ++i, time += kPeriod) sweep(speed);
  }

  /// @param output  m/s, error that is allowed to the filter
  void expectRight(double output = 0.1) const {
    EXPECT_TRUE(refusals.empty()) << refusals.size() << ": " << refusals.front();
    EXPECT_LE(worst_single, 0.1);
    EXPECT_LE(worst_output, output);
    EXPECT_GE(static_cast<double>(called_static), 0.98 * static_cast<double>(standing));
    EXPECT_EQ(unwrapped_wrong, 0U);
  }
};

TEST(AmbiguousDoppler, ARampThroughTheAmbiguityAndBack) {
  for (const MotionModel model :
       {MotionModel::kAckermann, MotionModel::kPlanarYaw, MotionModel::kPlanar, MotionModel::kSpatial}) {
    for (const double half_field_of_view : {15.0, 60.0}) {
      for (const double unambiguous : {12.8, 10.4}) {
        SCOPED_TRACE(std::string(toString(model)) + ' ' + std::to_string(half_field_of_view) + " degrees " +
                     std::to_string(unambiguous) + " m/s");
        AmbiguousDrive drive, reference;
        drive.unambiguous = {unambiguous};
        reference.unambiguous = {};
        for (AmbiguousDrive* one : {&reference, &drive}) {
          one->model = model;
          one->half_field_of_view = half_field_of_view;
          one->max_elevation = model == MotionModel::kSpatial ? 15.0 : 0.0;
          one->configure();
          one->ramp(0.0, 30.0);
          one->expectRight();
          one->hold(30.0, 20);
          one->ramp(30.0, 0.0, 8.0);  // so sudden that the filter needs a moment
          one->hold(0.0, 20);
          one->expectRight(reference.worst_output + 0.01);
        }
      }
    }
  }
}

TEST(AmbiguousDoppler, WithoutTheFilterInATurnAndInReverse) {
  AmbiguousDrive drive;
  drive.filter = false;
  drive.half_field_of_view = 15.0;
  drive.yaw_rate = 0.3;
  drive.configure();
  drive.ramp(0.0, 30.0);
  drive.ramp(30.0, -20.0);
  drive.expectRight();
}

TEST(AmbiguousDoppler, ACornerRadarAlone) {
  for (const double half_field_of_view : {15.0, 60.0}) {
    AmbiguousDrive drive;
    drive.mounts = {test::mount(3.2, 0.8, 0.5, 0.8)};
    drive.half_field_of_view = half_field_of_view;
    drive.model = MotionModel::kPlanar;
    drive.configure();
    drive.ramp(0.0, 30.0);
    EXPECT_TRUE(drive.refusals.empty());
    EXPECT_EQ(drive.unwrapped_wrong, 0U);
  }
}

TEST(AmbiguousDoppler, TheOtherRadarsDecide) {
  // Bearings too narrow to tell by themselves, and a start far above the ambiguity.
  for (const bool all_narrow : {true, false}) {
    AmbiguousDrive drive;
    drive.mounts = test::carMounts();
    drive.half_field_of_view = all_narrow ? 3.0 : 60.0;
    drive.unambiguous = {10.4};
    drive.configure();
    drive.ramp(25.0, 30.0);
    drive.expectRight();
    EXPECT_TRUE(drive.assumptions.empty());
  }
  AmbiguousDrive two;
  two.mounts = {test::mount(3.4, 0.5, 0.5, 0.0), test::mount(3.4, -0.5, 0.5, 0.0)};
  two.half_field_of_view = 3.0;
  two.unambiguous = {12.8, 10.4};
  two.model = MotionModel::kAckermann;
  two.configure();
  two.ramp(25.0, 30.0);
  two.expectRight();
  EXPECT_TRUE(two.assumptions.empty());
}

TEST(AmbiguousDoppler, WideBearingsTellWithoutAStart) {
  for (const double speed : {-14.7, 14.7, 28.0, 45.0}) {
    AmbiguousDrive drive;
    drive.returns_per_radar = speed < 20.0 ? 100 : 4000;
    drive.half_field_of_view = 15.0;
    drive.configure();
    drive.hold(speed, 5);
    drive.time += 10.0;  // longer than any velocity lasts
    drive.hold(-speed, 5);
    drive.expectRight();
    EXPECT_TRUE(drive.assumptions.empty());
  }
}

TEST(AmbiguousDoppler, WhatCannotBeToldIsRefusedExceptAtTheStart) {
  AmbiguousDrive drive;
  drive.half_field_of_view = 3.0;
  drive.model = MotionModel::kAckermann;
  drive.configure();
  drive.ramp(0.0, 30.0);
  drive.expectRight();
  ASSERT_EQ(drive.assumptions.size(), 1U) << "of the start alone";
  EXPECT_NE(drive.assumptions[0].find("12.80 m/s"), std::string::npos) << drive.assumptions[0];

  drive.hold(30.0, 20);
  drive.time += 0.5;  // can be bridged
  drive.hold(30.0, 20);
  drive.expectRight();

  drive.time += 3.0;
  drive.hold(20.0, 30);
  ASSERT_EQ(drive.refusals.size(), 30U);
  EXPECT_NE(drive.refusals[0].find("20.0"), std::string::npos) << drive.refusals[0];
  EXPECT_NE(drive.refusals[0].find("-5.6"), std::string::npos) << drive.refusals[0];
  drive.refusals.clear();
  drive.half_field_of_view = 15.0;  // now there is evidence
  drive.hold(20.0, 5);
  drive.expectRight();
}

TEST(AmbiguousDoppler, AWrongStartDoesNotOutlastTheEvidence) {
  AmbiguousDrive drive;
  drive.half_field_of_view = 3.0;
  drive.model = MotionModel::kAckermann;
  drive.configure();
  EXPECT_NEAR(drive.sweep(20.0).single.linear.x(), 20.0 - 2.0 * 12.8, 0.1) << "which breaks the assumption";
  EXPECT_EQ(drive.assumptions.size(), 1U);
  drive.half_field_of_view = 15.0;
  bool refused = false, recovered = false;
  for (int i = 0; i < 40; ++i) {
    drive.time += kPeriod;
    const EgoVelocityResult result = drive.sweep(20.0).single;
    refused = refused || result.status == EstimateStatus::kAmbiguous;
    recovered = result.valid();
    if (recovered) {
      EXPECT_NEAR(result.linear.x(), 20.0, 0.1);
    }
  }
  EXPECT_TRUE(refused);
  EXPECT_TRUE(recovered);
}

}  // namespace
}  // namespace radar_dot
