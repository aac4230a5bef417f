// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sensor_velocity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

using Eigen::Vector3d;

TEST(SensorVelocity, IsTheRigidMotionAtTheRadar) {
  test::SweepOptions options;
  options.moving_share = 0.2;
  const Vector3d v(6.0, -0.2, 0.0);
  const Vector3d w(0.0, 0.0, 0.3);
  const test::Sweep sweep = test::makeSweep(test::carMounts(), v, w, options);
  std::vector<RadarScan> scans = sweep.scans();
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i].radar = 10 + i;
  EgoVelocityEstimator estimator;
  const std::vector<SensorVelocity> sensors = sensorVelocities(scans, estimator.estimate(scans, 0.0));
  ASSERT_EQ(sensors.size(), scans.size());
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const Vector3d expected = v + w.cross(sweep.mounts[i].translation());
    EXPECT_EQ(sensors[i].radar, 10 + i);
    EXPECT_EQ(sensors[i].time, scans[i].time);
    EXPECT_LT((sensors[i].velocity - expected.head<2>()).norm(), 0.02) << "radar " << i;
    EXPECT_GT(sensors[i].covariance.determinant(), 0.0);
  }
}

// Normalised squared error: chi-square with two degrees of freedom per radar.
TEST(SensorVelocity, CovarianceIsConsistent) {
  test::SweepOptions options;
  options.doppler_sigma = 0.12;
  EgoVelocityParams params;
  params.sensor.sensor_scan_std = 0.0;
  params.noise.azimuth_std = 0.0;
  const Vector3d v(6.0, 0.0, 0.0);
  double sum = 0.0;
  std::size_t count = 0;
  EgoVelocityEstimator estimator;
  for (options.seed = 1; options.seed <= 100; ++options.seed) {
    const test::Sweep sweep = test::makeSweep(test::carMounts(), v, Vector3d::Zero(), options);
    const std::vector<RadarScan> scans = sweep.scans();
    for (const SensorVelocity& sensor : sensorVelocities(scans, estimator.estimate(scans, 0.0), params)) {
      const Eigen::Vector2d error = sensor.velocity - v.head<2>();
      sum += error.dot(sensor.covariance.inverse() * error);
      ++count;
    }
  }
  ASSERT_EQ(count, 500U);
  // Reweighting costs a little of the information that the covariance counts.
  EXPECT_GT(sum / 2.0 / static_cast<double>(count), 0.7);
  EXPECT_LT(sum / 2.0 / static_cast<double>(count), 1.2);
}

TEST(SensorVelocity, NeedsStaticReturnsAndAValidEstimate) {
  const test::Sweep sweep = test::makeSweep(test::carMounts(), {6.0, 0.0, 0.0}, Vector3d::Zero());
  std::vector<RadarScan> scans = sweep.scans();
  EgoVelocityEstimator estimator;
  EXPECT_TRUE(sensorVelocities(scans, EgoVelocityResult{}).empty());
  scans[1].known_dynamic.assign(scans[1].returns.size(), 1);
  EXPECT_EQ(sensorVelocities(scans, estimator.estimate(scans, 0.0)).size(), scans.size() - 1);
}

/// Returns as a radar gives them whose vectors (vx, vy) hold its turning, and whose positions are `delay`
/// later.
std::vector<DopplerReturn> lateReturns(const Vector3d& velocity, double yaw_rate, double delay) {
  std::vector<DopplerReturn> returns;
  for (int i = 0; i < 60; ++i) {
    const double azimuth = -1.0 + i / 30.0;
    const double range = 10.0 + i;
    const Vector3d u(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vector3d relative = -velocity - Vector3d(0.0, 0.0, yaw_rate).cross(range * u);
    // Static objects turn against the vehicle in its frame.
    const double later = azimuth - yaw_rate * delay;
    DopplerReturn& seen = returns.emplace_back();
    seen.bearing = Eigen::Vector3d(std::cos(later), std::sin(later), 0.0).cast<float>();
    seen.range = static_cast<float>(range);
    seen.doppler = static_cast<float>(std::cos(later) * relative.x() + std::sin(later) * relative.y());
    seen.tangential_speed =
        static_cast<float>(std::cos(later) * relative.y() - std::sin(later) * relative.x());
  }
  return returns;
}

TEST(BearingRotation, BringsBearingsToTheTimeOfTheVelocities) {
  const Vector3d v(4.0, 0.2, 0.0);
  constexpr double kYawRate = 0.4;
  constexpr double kDelay = 0.04;
  const std::vector<DopplerReturn> returns = lateReturns(v, kYawRate, kDelay);
  EgoVelocityParams params;
  params.model = MotionModel::kPlanar;  // the radar is at the origin: it does not see the yaw rate
  EgoVelocityEstimator estimator(params);
  for (const double side : {1.0, -1.0}) {  // upright, and hanging upside down
    Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
    std::vector<DopplerReturn> seen = returns;
    if (side < 0.0) {
      mount.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
      for (DopplerReturn& r : seen) {
        r.bearing.y() *= -1.F;
        r.tangential_speed *= -1.F;
      }
    }
    RadarScan scan{seen, mount, 0.0};
    const Vector3d late = estimator.estimate({scan}, 0.0).linear;
    EXPECT_GT((late - v).norm(), 0.1) << "what the delay does";
    scan.bearing_rotation = kDelay * kYawRate;
    const Vector3d turned = estimator.estimate({scan}, 0.0).linear;
    EXPECT_LT((turned - v).norm(), 0.01);
  }
}

}  // namespace
}  // namespace radar_dot
