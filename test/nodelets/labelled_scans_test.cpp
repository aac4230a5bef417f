// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/labelled_scans.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fixtures/refusal.h"
#include "nodelets/float_cloud.h"

namespace radar_dot {
namespace {

using test::expectRefusal;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// x, y, z (m) and residual (m/s) of each point.
sensor_msgs::PointCloud2 cloudOf(const std::string& frame, double stamp, const std::vector<float>& values,
                                 std::uint32_t columns = 4) {
  std::vector<std::string> names = {"x", "y", "z", "residual"};
  names.resize(columns);
  sensor_msgs::PointCloud2 cloud = test::floatCloud(names, values);
  cloud.header.frame_id = frame;
  cloud.header.stamp = ros::Time(stamp);
  return cloud;
}

constexpr ReturnLabel kStatic = ReturnLabel::kStatic, kDynamic = ReturnLabel::kDynamic;
constexpr double kPatient = 100.0;  // s

TEST(LabelledScans, TwoCloudsOfOneFrameAndStampAreOneScan) {
  LabelledScans scans;
  scans.add(cloudOf("front", 10.0, {5.F, 0.F, 0.F, 0.1F}), kStatic, {});
  EXPECT_TRUE(scans.take(kPatient, {}).empty());
  scans.add(cloudOf("front", 10.0, {7.F, 0.F, 0.F, 3.F, 8.F, 0.F, 0.F, 3.F}), kDynamic, {});
  const std::vector<LabelledScan> ready = scans.take(kPatient, {});
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_EQ(ready[0].frame, "front");
  EXPECT_EQ(ready[0].stamp, ros::Time(10.0));
  ASSERT_TRUE(ready[0].complete());
  EXPECT_EQ(ready[0].still->size(), 1U);
  EXPECT_EQ(ready[0].moving->size(), 2U);
  EXPECT_TRUE(scans.take(kPatient, {}).empty());
}

// EgoVelocity sends the static clouds of a sweep first, radar by radar.
TEST(LabelledScans, AScanWaitsForOlderOnes) {
  LabelledScans scans;
  scans.add(cloudOf("front", 10.05, {}), kStatic, {});
  scans.add(cloudOf("left", 10.0, {}), kStatic, {});
  scans.add(cloudOf("front", 10.05, {}), kDynamic, {});
  EXPECT_TRUE(scans.take(kPatient, {}).empty());
  scans.add(cloudOf("left", 10.0, {}), kDynamic, {});
  const std::vector<LabelledScan> ready = scans.take(kPatient, {});
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_EQ(ready[0].frame, "left");
  EXPECT_EQ(ready[1].frame, "front");
  EXPECT_NE(ready[0].radar, ready[1].radar);
  scans.add(cloudOf("left", 10.1, {}), kStatic, {});
  scans.add(cloudOf("left", 10.1, {}), kDynamic, {});
  EXPECT_EQ(scans.take(kPatient, {}).at(0).radar, ready[0].radar) << "a radar keeps its number";
}

TEST(LabelledScans, AfterItsTimeAScanGoesWithWhatThereIs) {
  LabelledScans scans;
  scans.add(cloudOf("front", 10.0, {7.F, 0.F, 0.F, 3.F}), kDynamic, {});
  const std::vector<LabelledScan> ready = scans.take(0.0, {});
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_FALSE(ready[0].complete());
  EXPECT_EQ(ready[0].moving->size(), 1U);
  expectRefusal([&] { scans.add(cloudOf("front", 10.0, {}), kStatic, {}); }, {"already used"});
}

TEST(LabelledScans, CloudsOfNoUseAreRefused) {
  LabelledScans scans;
  expectRefusal([&] { scans.add(cloudOf("front", 10.0, {1.F, 2.F, 3.F}, 3), kStatic, {}); }, {"residual"});
  expectRefusal([&] { scans.add(cloudOf("front", 10.0, {1.F, 2.F, 3.F, kNaN}), kStatic, {}); }, {"residual"});
  sensor_msgs::PointCloud2 broken = cloudOf("front", 10.0, {1.F, 2.F, 3.F, 0.F});
  broken.data.pop_back();
  expectRefusal([&] { scans.add(broken, kStatic, {}); }, {"bytes of data"});
  scans.add(cloudOf("front", 10.0, {}), kStatic, {});
  expectRefusal([&] { scans.add(cloudOf("front", 10.0, {}), kStatic, {}); }, {"that of the cloud before"});
  scans.add(cloudOf("front", 10.0, {}), kDynamic, {});
  scans.take(kPatient, {});
  expectRefusal([&] { scans.add(cloudOf("front", 9.0, {}), kStatic, {}); }, {"already used"});
  scans.clear();
  scans.add(cloudOf("front", 9.0, {}), kStatic, {});
  scans.add(cloudOf("front", 9.0, {}), kDynamic, {});
  EXPECT_EQ(scans.take(kPatient, {}).size(), 1U) << "time may be reset";
}

TEST(LabelledScans, ASilentTopicDoesNotFillTheMemory) {
  LabelledScans scans;
  for (int i = 0; i < 150; ++i) scans.add(cloudOf("front", 10.0 + i, {}), kStatic, {});
  EXPECT_EQ(scans.take(kPatient, {}).size(), 50U);
}

// A radar at (3, 1) that looks to the left, on a vehicle with 10 m/s and 0.5 rad/s.
TEST(ReturnsOf, VelocitiesAreTheResidualsAndPositionsAreInTheBaseFrame) {
  LabelledScan scan;
  scan.stamp = ros::Time(12.5);
  scan.radar = 3;
  scan.still = std::vector<CloudPoint>{{{20.F, 0.F, 0.F}, 0.1F}, {{50.F, 10.F, 0.F}, -2.F}};
  scan.moving = std::vector<CloudPoint>{{{0.F, 40.F, 0.F}, 0.25F}};
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.linear() = Eigen::AngleAxisd(std::acos(-1.0) / 2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  mount.translation() = Eigen::Vector3d(3.0, 1.0, 0.5);
  StampedTwist velocity;
  velocity.linear.x() = 10.0;
  velocity.angular.z() = 0.5;
  const std::vector<ReturnOverGround> returns = returnsOf(scan, mount, velocity, {});
  ASSERT_EQ(returns.size(), 3U);
  EXPECT_NEAR((returns[0].position - Eigen::Vector2d(3.0, 21.0)).norm(), 0.0, 1e-5);
  EXPECT_NEAR((returns[2].position - Eigen::Vector2d(-37.0, 1.0)).norm(), 0.0, 1e-5);
  EXPECT_NEAR(returns[0].velocity, 0.1, 1e-5);
  EXPECT_NEAR(returns[1].velocity, -2.0, 1e-5);
  EXPECT_NEAR(returns[2].velocity, 0.25, 1e-5);
  EXPECT_EQ(returns[0].label, kStatic);
  EXPECT_EQ(returns[1].label, kDynamic) << "beyond the thresholds";
  EXPECT_EQ(returns[2].label, kDynamic) << "as EgoVelocity has said";
  // The mount moves with (10, 0) + 0.5 (-1, 3) = (9.5, 1.5): 9.5 m/s across the line of sight of the first.
  const OverGroundParams params;
  EXPECT_NEAR(returns[0].variance,
              std::pow(params.noise.doppler_std, 2) + std::pow(params.noise.azimuth_std * 9.5, 2), 1e-6);
  for (const ReturnOverGround& one : returns) {
    EXPECT_EQ(one.time, 12.5);
    EXPECT_EQ(one.radar, 3U);
    EXPECT_EQ(one.sensor, Eigen::Vector2d(3.0, 1.0));
  }
}

TEST(ReturnsOf, AMissingHalfIsNoReturns) {
  LabelledScan scan;
  scan.stamp = ros::Time(12.5);
  EXPECT_TRUE(returnsOf(scan, Eigen::Isometry3d::Identity(), {}, {}).empty());
}

}  // namespace
}  // namespace radar_dot
