// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/velocity_chain.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "radar/synthetic_sweep.h"

namespace radar_dot {
namespace {

constexpr double kPeriod = 0.075;  // s

/// The chain after a drive of so many sweeps. @param turned  rad, of the first radar's mount
EgoVelocityResult drive(VelocityChain& chain, double begin, int sweeps, double turned = 0.0) {
  EgoVelocityResult latest;
  for (int i = 0; i < sweeps; ++i) {
    test::SweepOptions options;
    options.seed = static_cast<std::uint32_t>(i + 1);
    options.doppler_sigma = 0.05;
    const test::Sweep sweep = test::makeSweep(test::carMounts(), {10.0, 0.0, 0.0}, {0.0, 0.0, 0.05}, options);
    std::vector<RadarScan> scans = sweep.scans();
    const double time = begin + kPeriod * i;
    for (std::size_t radar = 0; radar < scans.size(); ++radar) {
      scans[radar].time = time;
      scans[radar].radar = radar;
    }
    scans[0].T_base_from_sensor.linear() =
        Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) * scans[0].T_base_from_sensor.linear();
    const EgoVelocityResult& result = chain.estimate(scans, time);
    EXPECT_TRUE(result.valid()) << result.reason;
    const std::optional<VelocityChain::Filtered> filtered = chain.filtered(time, scans, result);
    EXPECT_TRUE(filtered) << i;
    if (!filtered) continue;
    EXPECT_FALSE(filtered->was_reset) << i;
    latest = filtered->velocity;
  }
  return latest;
}

EgoVelocityConfig mountsToLearn() {
  EgoVelocityConfig config;
  config.filter_params.lateral_slip_std = 0.01;
  config.filter_params.mount_yaw_std = 0.02;
  return config;
}

TEST(VelocityChain, AMaskParameterKeepsWhatTheFilterHasLearnt) {
  VelocityChain chain;
  EgoVelocityConfig config = mountsToLearn();
  chain.configure(config);
  const EgoVelocityResult before = drive(chain, 0.0, 40, -0.02);
  const double learnt = chain.filter().mountYaw(0);
  EXPECT_GT(std::abs(learnt), 0.005) << "there is something to lose";

  config.use_mask = true;
  config.mask_max_age = 0.7;
  config.footprint.top = 2.0;
  config.extraction.filter.max_range = 100.0;
  config.estimator.inlier_threshold = 0.25;
  config.bearing_delay = 0.01;
  chain.configure(config);
  EXPECT_TRUE(chain.filter().started());
  EXPECT_EQ(chain.filter().mountYaw(0), learnt);
  EXPECT_EQ(chain.params().inlier_threshold, 0.25);
  const EgoVelocityResult after = drive(chain, 40 * kPeriod, 1, -0.02);
  EXPECT_NEAR(after.linear.x(), before.linear.x(), 0.05);
  EXPECT_LT(after.covariance(0, 0), 1.5 * before.covariance(0, 0)) << "a filter that starts is less certain";
}

TEST(VelocityChain, AParameterOfTheFilterStartsItAgain) {
  VelocityChain chain;
  EgoVelocityConfig config = mountsToLearn();
  chain.configure(config);
  drive(chain, 0.0, 10);
  ASSERT_TRUE(chain.filter().started());
  config.filter_params.lateral_jerk = 0.5;
  chain.configure(config);
  EXPECT_FALSE(chain.filter().started());
  EXPECT_EQ(chain.filter().params().lateral_jerk, 0.5);
}

TEST(VelocityChain, WhatCannotBeConfiguredChangesNothing) {
  VelocityChain chain;
  EgoVelocityConfig config = mountsToLearn();
  chain.configure(config);
  drive(chain, 0.0, 10);
  EgoVelocityConfig wrong = config;
  wrong.estimator.inlier_threshold = 0.2;
  wrong.filter_params.lateral_slip_std = -1.0;
  EXPECT_THROW(chain.configure(wrong), InvalidParameter);
  EXPECT_EQ(chain.params().inlier_threshold, config.estimator.inlier_threshold);
  EXPECT_TRUE(chain.filter().started());
}

// The filter weighs each radar by the configured noise, not by its default.
TEST(VelocityChain, ALargerDopplerStdWidensTheFilteredCovariance) {
  const auto filtered = [](double doppler_std) {
    VelocityChain chain;
    EgoVelocityConfig config;
    config.estimator.noise.doppler_std = doppler_std;
    chain.configure(config);
    return drive(chain, 0.0, 20);
  };
  const EgoVelocityResult usual = filtered(0.12), noisy = filtered(0.48);
  EXPECT_GT(noisy.covariance(0, 0), 2.0 * usual.covariance(0, 0));
  EXPECT_GT(noisy.covariance(1, 1), 2.0 * usual.covariance(1, 1));
  EXPECT_NEAR(noisy.linear.x(), 10.0, 0.1);
}

TEST(VelocityChain, ParametersOfTheSingleRadarsArrive) {
  VelocityChain chain;
  EgoVelocityConfig config;
  config.estimator.sensor.min_sensor_returns = 7;
  config.estimator.sensor.sensor_scan_std = 0.05;
  chain.configure(config);
  EXPECT_EQ(chain.params().sensor.min_sensor_returns, 7);
  EXPECT_EQ(chain.params().sensor.sensor_scan_std, 0.05);
}

TEST(VelocityChain, BearingsTurnWithTheLatestYawRate) {
  VelocityChain chain;
  EgoVelocityConfig config;
  config.bearing_delay = 0.04;
  chain.configure(config);
  EXPECT_EQ(chain.bearingRotation(0.0), 0.0) << "nothing is known yet";
  drive(chain, 0.0, 1);
  EXPECT_NEAR(chain.bearingRotation(kPeriod), 0.04 * 0.05, 5e-4);
  EXPECT_EQ(chain.bearingRotation(5.0), 0.0) << "too long ago";
  chain.reset();
  EXPECT_EQ(chain.bearingRotation(kPeriod), 0.0);
}

}  // namespace
}  // namespace radar_dot
