// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/mask_feedback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace radar_dot::evaluation {
namespace {

/// Looks along x from 1 m above the ground, 640 px to the slope. Marks the columns between two.
StampedMask maskOf(double time, int first_column, int last_column) {
  StampedMask mask;
  mask.time = time;
  mask.camera = {640.0, 640.0, 400.0, 225.0, 800, 450};
  mask.mask = cv::Mat::zeros(450, 800, CV_8UC1);
  mask.mask.colRange(first_column, last_column + 1).setTo(255);
  mask.T_camera_from_base.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  mask.T_camera_from_base.translation() = Eigen::Vector3d(0.0, 1.0, 0.0);
  return mask;
}

DopplerReturn returnAt(float x, float y) {
  DopplerReturn seen;
  const Eigen::Vector3f position(x, y, 0.0F);
  seen.range = position.norm();
  seen.bearing = position / seen.range;
  return seen;
}

// What stands at (20, 3) is at (15, 3) half a second later at 10 m/s: column 400 - 640 * 3 / 20 = 304 in the
// mask, and 272 as if the car had stood.
TEST(MaskFeedback, ReturnsAreBroughtToTheTimeOfTheMask) {
  const std::vector<DopplerReturn> returns = {returnAt(15.0F, 3.0F), returnAt(15.0F, -3.0F)};
  RadarScan scan{&returns, Eigen::Isometry3d::Identity(), 7.5, nullptr};
  StampedTwist velocity;
  const StampedMask then = maskOf(7.0, 302, 306);
  EXPECT_EQ(returnsInMask(scan, then, velocity), (std::vector<std::uint8_t>{0, 0}));
  velocity.linear.x() = 10.0;
  EXPECT_EQ(returnsInMask(scan, then, velocity), (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(returnsInMask(scan, maskOf(7.0, 270, 274), velocity), (std::vector<std::uint8_t>{0, 0}));
  // With a radar 2 m ahead of the base the same returns stand at 22 m: column 313.
  scan.T_base_from_sensor.translation().x() = 2.0;
  EXPECT_EQ(returnsInMask(scan, maskOf(7.0, 311, 315), velocity), (std::vector<std::uint8_t>{1, 0}));
}

// After a turn to the left by 0.1 rad what was straight ahead is to the right.
TEST(MaskFeedback, TheTurnSinceTheMaskCounts) {
  const std::vector<DopplerReturn> returns = {returnAt(20.0F * std::cos(0.1F), -20.0F * std::sin(0.1F))};
  const RadarScan scan{&returns, Eigen::Isometry3d::Identity(), 0.5, nullptr};
  StampedTwist velocity;
  velocity.angular.z() = 0.2;
  EXPECT_EQ(returnsInMask(scan, maskOf(0.0, 398, 402), velocity), (std::vector<std::uint8_t>{1}));
  velocity.angular.z() = -0.2;
  EXPECT_EQ(returnsInMask(scan, maskOf(0.0, 398, 402), velocity), (std::vector<std::uint8_t>{0}));
}

TEST(MaskFeedback, OnlyScansWithinTheLimitHaveAMask) {
  const std::vector<DopplerReturn> returns = {returnAt(15.0F, 0.0F)};
  std::vector<RadarScan> scans;
  for (const double time : {9.75, 10.0, 10.25, 10.5, 10.625})
    scans.push_back({&returns, Eigen::Isometry3d::Identity(), time, nullptr});
  const StampedMask mask = maskOf(10.0, 0, 799);
  StampedTwist velocity;
  velocity.time = 10.0;
  EgoVelocityConfig config;
  config.mask_max_age = 0.5;
  MaskFeedback feedback(config);
  feedback.mark(
      scans, [&mask](double) { return &mask; }, velocity);
  EXPECT_EQ(scans[0].known_dynamic, nullptr);  // before the mask
  for (const std::size_t marked : {1U, 2U, 3U}) {
    ASSERT_NE(scans[marked].known_dynamic, nullptr);
    EXPECT_EQ(*scans[marked].known_dynamic, (std::vector<std::uint8_t>{1}));
  }
  EXPECT_EQ(scans[4].known_dynamic, nullptr);  // too old
}

TEST(MaskFeedback, NothingIsKnownWithoutAMaskOrAFreshVelocity) {
  const std::vector<DopplerReturn> returns = {returnAt(15.0F, 0.0F)};
  std::vector<RadarScan> scans = {{&returns, Eigen::Isometry3d::Identity(), 10.25, nullptr}};
  const StampedMask mask = maskOf(10.0, 0, 799);
  StampedTwist velocity;
  velocity.time = 9.0;
  EgoVelocityConfig config;
  config.mask_max_age = 0.5;
  MaskFeedback feedback(config);
  feedback.mark(
      scans, [&mask](double) { return &mask; }, velocity);
  EXPECT_EQ(scans[0].known_dynamic, nullptr);
  velocity.time = 9.5;
  feedback.mark(
      scans, [](double) { return nullptr; }, velocity);
  EXPECT_EQ(scans[0].known_dynamic, nullptr);
  feedback.mark(
      scans, [&mask](double) { return &mask; }, velocity);
  EXPECT_NE(scans[0].known_dynamic, nullptr);
}

}  // namespace
}  // namespace radar_dot::evaluation
