// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/returns_over_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace radar_dot {
namespace {

using Eigen::Vector3d;

const Vector3d kLinear(10.0, 0.2, 0.0);
const Vector3d kAngular(0.0, 0.0, 0.3);

/// A radar on the left corner, looking to the left.
Eigen::Isometry3d mount() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Vector3d(3.0, 0.8, 0.5);
  T.linear() = Eigen::AngleAxisd(1.0, Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// What it measures of a point at `position` (base frame, its own height) that moves with `velocity`.
DopplerReturn seenAt(const Vector3d& position, const Vector3d& velocity) {
  const Vector3d from_sensor = position - mount().translation();
  const Vector3d relative = velocity - kLinear - kAngular.cross(mount().translation());
  DopplerReturn measured;
  measured.range = static_cast<float>(from_sensor.norm());
  measured.bearing = (mount().linear().transpose() * from_sensor.normalized()).cast<float>();
  measured.doppler = static_cast<float>(from_sensor.normalized().dot(relative));
  return measured;
}

TEST(ReturnsOverGround, StaticOnesStandAndMoversHaveTheirRadialVelocity) {
  const Vector3d position(10.0, 9.0, 0.5), velocity(-4.0, -2.0, 0.0);
  const std::vector<DopplerReturn> returns = {seenAt({8.0, 20.0, 0.5}, Vector3d::Zero()),
                                              seenAt(position, velocity)};
  RadarScan scan{returns, mount(), 7.0};
  scan.radar = 3;
  const auto over = returnsOverGround(scan, kLinear, kAngular);
  ASSERT_EQ(over.size(), 2U);
  EXPECT_NEAR(over[0].velocity, 0.0, 1e-5);
  EXPECT_EQ(over[0].label, ReturnLabel::kStatic);
  const Vector3d along = (position - mount().translation()).normalized();
  EXPECT_NEAR(over[1].velocity, along.dot(velocity), 1e-5);
  EXPECT_EQ(over[1].label, ReturnLabel::kDynamic);
  EXPECT_LT((over[1].position - position.head<2>()).norm(), 1e-5);
  EXPECT_LT((over[1].bearing() - along.head<2>()).norm(), 1e-5);
  EXPECT_EQ(over[1].time, 7.0);
  EXPECT_EQ(over[1].radar, 3U);
  EXPECT_EQ(over[1].index, 1U);
}

// The uncertainty of a position grows across the line of sight, that of a velocity with the speed across it.
TEST(ReturnsOverGround, CovarianceFollowsTheGeometry) {
  const std::vector<DopplerReturn> returns = {seenAt({3.0, 40.8, 0.5}, Vector3d::Zero())};
  OverGroundParams params;
  params.range_std = 0.2;
  params.noise.azimuth_std = 0.02;
  params.noise.doppler_std = 0.1;
  const auto over = returnsOverGround({returns, mount(), 0.0}, kLinear, kAngular, params);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_NEAR(over[0].covariance(1, 1), 0.04, 1e-4) << "range, straight to the left";
  EXPECT_NEAR(over[0].covariance(0, 0), 0.8 * 0.8, 1e-3) << "0.02 rad at 40 m";
  const double across = 10.0 - 0.3 * 0.8;
  EXPECT_NEAR(over[0].variance, 0.01 + std::pow(0.02 * across, 2), 1e-4);
}

TEST(ReturnsOverGround, LeavesOutWhatIsNotFiniteAndBelievesTheMask) {
  std::vector<DopplerReturn> returns = {seenAt({8.0, 20.0, 0.5}, Vector3d::Zero()),
                                        seenAt({8.0, 30.0, 0.5}, Vector3d::Zero())};
  returns[0].doppler = std::numeric_limits<float>::quiet_NaN();
  RadarScan scan{returns, mount(), 0.0};
  scan.known_dynamic = {0, 1};
  const auto over = returnsOverGround(scan, kLinear, kAngular);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over[0].index, 1U);
  EXPECT_EQ(over[0].label, ReturnLabel::kDynamic);
  EXPECT_TRUE(returnsOverGround(RadarScan{}, kLinear, kAngular).empty());

  scan.known_dynamic = {1};  // of the first return alone: nothing is known of the second
  EXPECT_EQ(returnsOverGround(scan, kLinear, kAngular).at(0).label, ReturnLabel::kStatic);
}

}  // namespace
}  // namespace radar_dot
