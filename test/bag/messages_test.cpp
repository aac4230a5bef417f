// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "radar_dot/bag/ground_truth.h"
#include "radar_dot/common/stamps.h"

namespace radar_dot::bag {
namespace {

constexpr std::int64_t kStart = 1'532'402'927'647'951;  // us

TEST(Messages, StampsAreExactToTheMicrosecond) {
  for (std::int64_t offset = 0; offset < 3'000'000; offset += 7'919) {
    const ros::Time time = toTime(kStart + offset);
    EXPECT_EQ(static_cast<std::int64_t>(time.toNSec()), (kStart + offset) * 1000);
  }
  EXPECT_THROW(toTime(0), dataset::DatasetError);
  EXPECT_THROW(toTime(-5), dataset::DatasetError);
  EXPECT_THROW(toTime(4'294'967'296'000'000), dataset::DatasetError);
  EXPECT_EQ(toTime(4'294'967'295'999'999).sec, 4'294'967'295U);
}

// What runs offline and what runs live must agree to the last digit.
TEST(Messages, SecondsOfAStampAreThoseOfRos) {
  std::size_t elsewhere = 0;
  for (std::int64_t stamp = kStart; stamp < kStart + 10000000; stamp += 7777) {
    ASSERT_EQ(secondsOf(stamp), toTime(stamp).toSec());
    if (1e-6 * static_cast<double>(stamp) != toTime(stamp).toSec()) ++elsewhere;
  }
  EXPECT_GT(elsewhere, 0U) << "a product rounds some of them to the double beside it";
}

TEST(Messages, FramesAreChannelsInLowerCase) {
  EXPECT_EQ(frameOf("RADAR_FRONT"), "radar_front");
  EXPECT_EQ(frameOf("LIDAR_TOP"), "lidar_top");
}

TEST(Messages, CloudsKeepFieldsAndBytes) {
  PointCloud cloud;
  cloud.fields = {
      {"x", 0, ScalarType::kFloat32, 1}, {"id", 4, ScalarType::kInt16, 3}, {"ok", 10, ScalarType::kInt8, 1}};
  cloud.point_step = 11;
  cloud.size = 2;
  for (std::uint8_t i = 0; i < 22; ++i) cloud.data.push_back(i);
  const std::vector<std::uint8_t> bytes = cloud.data;
  const sensor_msgs::PointCloud2 message = toPointCloud2(std::move(cloud), "radar_front", toTime(kStart));
  ASSERT_EQ(message.fields.size(), 3U);
  EXPECT_EQ(message.fields[1].name, "id");
  EXPECT_EQ(message.fields[1].offset, 4U);
  EXPECT_EQ(message.fields[1].datatype, sensor_msgs::PointField::INT16);
  EXPECT_EQ(message.fields[1].count, 3U);
  EXPECT_EQ(message.fields[2].datatype, sensor_msgs::PointField::INT8);
  EXPECT_EQ(message.width, 2U);
  EXPECT_EQ(message.height, 1U);
  EXPECT_EQ(message.row_step, 22U);
  EXPECT_FALSE(message.is_dense);
  EXPECT_EQ(message.data, bytes);
}

TEST(Messages, ACameraWithoutMatrixIsUncalibrated) {
  dataset::CalibratedSensor sensor;
  dataset::SampleData reading;
  reading.width = 1600;
  reading.height = 900;
  EXPECT_EQ(toCameraInfo(sensor, reading, "cam_front", toTime(kStart)).K[0], 0.0);
  sensor.camera_matrix = (Eigen::Matrix3d() << 1266.4, 0.5, 816.2, 0, 1266.5, 491.5, 0, 0, 1).finished();
  const sensor_msgs::CameraInfo info = toCameraInfo(sensor, reading, "cam_front", toTime(kStart));
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double expected =
          (*sensor.camera_matrix)(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      EXPECT_EQ(info.K[3 * row + column], expected);
      EXPECT_EQ(info.P[4 * row + column], expected);
      EXPECT_EQ(info.R[3 * row + column], row == column ? 1.0 : 0.0);
    }
    EXPECT_EQ(info.P[4 * row + 3], 0.0);
  }
  EXPECT_EQ(info.D, std::vector<double>(5, 0.0));
  EXPECT_EQ(info.width, 1600U);
  EXPECT_EQ(info.height, 900U);
}

TEST(Messages, WheelsTellOnlyTheForwardSpeed) {
  dataset::CanVehicleInfo info;
  info.timestamp_us = kStart;
  info.rear_left_rpm = info.rear_right_rpm = 300.0;
  const geometry_msgs::TwistWithCovarianceStamped message = toWheelSpeed(info);
  EXPECT_NEAR(message.twist.twist.linear.x, 300.0 / 60.0 * 2.0 * M_PI * dataset::kZoeWheelRadius, 1e-9);
  EXPECT_LT(message.twist.covariance[0], 0.1);
  for (std::size_t axis = 1; axis < 6; ++axis) EXPECT_GE(message.twist.covariance[7 * axis], 1e3);
}

/// Poses of a drive with constant velocity and turn rate in the base frame.
dataset::Tables arc(double speed, double rate, double noise, unsigned seed,
                    const std::vector<double>& times) {
  std::mt19937 random(seed);
  std::normal_distribution<double> jitter(0.0, 1.0);
  dataset::Tables tables;
  for (const double t : times) {
    const double yaw = 0.7 + rate * t;
    dataset::EgoPose pose;
    pose.timestamp_us = kStart + std::llround(1e6 * t);
    // Far from the map's origin, as in nuScenes.
    pose.translation = {1010.0 + speed / rate * std::sin(yaw) + noise * jitter(random),
                        2020.0 - speed / rate * std::cos(yaw) + noise * jitter(random), 0.0};
    pose.rotation = {std::cos(yaw / 2), 0.0, 0.0, std::sin(yaw / 2)};
    tables.ego_poses.push_back(pose);
  }
  return tables;
}

std::vector<dataset::Index> rows(std::size_t count) {
  std::vector<dataset::Index> indices;
  for (std::size_t i = 0; i < count; ++i) indices.push_back(static_cast<dataset::Index>(i));
  return indices;
}

std::vector<double> irregularTimes(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.001, 0.02);
  std::vector<double> times;
  for (double t = 0.0; t < 4.0; t += step(random)) times.push_back(t);
  return times;
}

TEST(EgoTwists, RecoverConstantVelocityAndTurnRate) {
  const std::vector<double> times = irregularTimes(11);
  for (const double rate : {0.3, -0.5, 1e-6}) {
    const dataset::Tables tables = arc(9.0, rate, 0.0, 1, times);
    const std::vector<StampedTwist> twists = egoTwists(tables, rows(times.size()));
    ASSERT_EQ(twists.size(), times.size());
    for (std::size_t i = 0; i < twists.size(); ++i) {
      const bool inner = times[i] > kTwistHalfWindow && times[i] < times.back() - kTwistHalfWindow;
      // One-sided at the ends: half a window late or early, so the heading is off by that much.
      const double tolerance = inner ? 5e-3 : 9.0 * std::abs(rate) * kTwistHalfWindow / 2 + 5e-3;
      EXPECT_NEAR(twists[i].linear.x(), 9.0, tolerance) << "t = " << times[i];
      EXPECT_NEAR(twists[i].linear.y(), 0.0, tolerance) << "t = " << times[i];
      EXPECT_NEAR(twists[i].angular.z(), rate, 1e-4) << "t = " << times[i];
      EXPECT_NEAR(twists[i].angular.head<2>().norm(), 0.0, 1e-6);
    }
  }
}

TEST(EgoTwists, JitterOfThePosesDoesNotDominate) {
  const std::vector<double> times = irregularTimes(12);
  const dataset::Tables tables = arc(9.0, 0.3, 0.005, 13, times);  // 5 mm
  const auto twists = egoTwists(tables, rows(times.size()));
  ASSERT_EQ(twists.size(), times.size());
  for (const auto& twist : twists) EXPECT_NEAR(twist.linear.x(), 9.0, 0.4);
}

TEST(EgoTwists, AreZeroWithoutASecondPose) {
  const dataset::Tables tables = arc(9.0, 0.3, 0.0, 1, {0.0});
  EXPECT_TRUE(egoTwists(tables, {}).empty());
  const std::vector<StampedTwist> twists = egoTwists(tables, rows(1));
  ASSERT_EQ(twists.size(), 1U);
  EXPECT_EQ(twists[0].linear.norm(), 0.0);
  EXPECT_EQ(twists[0].angular.norm(), 0.0);
}

}  // namespace
}  // namespace radar_dot::bag
