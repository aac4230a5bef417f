// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/mask_marking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace radar_dot {
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

/// Velocities that do not change.
TwistHistory moving(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  TwistHistory history(20.0, 20.0);
  for (const double time : {0.0, 20.0}) history.add({time, linear, angular});
  return history;
}

const TwistHistory kStanding = moving(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());

using Flags = std::vector<std::uint8_t>;

Flags marked(RadarScan scan, const StampedMask& mask, const TwistHistory& motion) {
  EXPECT_EQ(markReturns(scan, mask, 0.5, {}, motion), "");
  return scan.known_dynamic;
}

// What stands at (20, 3) is at (15, 3) half a second later at 10 m/s: column 400 - 640 * 3 / 20 = 304 in the
// mask, and 272 as if the car had stood.
TEST(MaskMarking, ReturnsAreBroughtToTheTimeOfTheMask) {
  const std::vector<DopplerReturn> returns = {returnAt(15.0F, 3.0F), returnAt(15.0F, -3.0F)};
  RadarScan scan{returns, Eigen::Isometry3d::Identity(), 7.5};
  const StampedMask then = maskOf(7.0, 302, 306);
  EXPECT_EQ(marked(scan, then, kStanding), (Flags{0, 0}));
  const TwistHistory motion = moving({10.0, 0.0, 0.0}, Eigen::Vector3d::Zero());
  EXPECT_EQ(marked(scan, then, motion), (Flags{1, 0}));
  EXPECT_EQ(marked(scan, maskOf(7.0, 270, 274), motion), (Flags{0, 0}));
  // With a radar 2 m ahead of the base the same returns stand at 22 m: column 313.
  scan.T_base_from_sensor.translation().x() = 2.0;
  EXPECT_EQ(marked(scan, maskOf(7.0, 311, 315), motion), (Flags{1, 0}));
}

// After a turn to the left by 0.1 rad what was straight ahead is to the right.
TEST(MaskMarking, TheTurnSinceTheMaskCounts) {
  const std::vector<DopplerReturn> returns = {returnAt(20.0F * std::cos(0.1F), -20.0F * std::sin(0.1F))};
  const RadarScan scan{returns, Eigen::Isometry3d::Identity(), 0.5};
  for (const auto& [yaw_rate, in_mask] : {std::pair{0.2, 1}, {-0.2, 0}}) {
    const TwistHistory motion = moving(Eigen::Vector3d::Zero(), {0.0, 0.0, yaw_rate});
    EXPECT_EQ(marked(scan, maskOf(0.0, 398, 402), motion), Flags(1, static_cast<std::uint8_t>(in_mask)));
  }
}

TEST(MaskMarking, OnlyScansWithinTheLimitAreMarked) {
  const std::vector<DopplerReturn> returns = {returnAt(15.0F, 0.0F)};
  const StampedMask mask = maskOf(10.0, 0, 799);
  const auto reason = [&](double time, const TwistHistory& motion = kStanding) {
    RadarScan scan{returns, Eigen::Isometry3d::Identity(), time};
    const std::string text = markReturns(scan, mask, 0.5, {}, motion);
    EXPECT_EQ(scan.known_dynamic, text.empty() ? Flags{1} : Flags{}) << time;
    return text;
  };
  for (const double time : {10.0, 10.25, 10.5}) EXPECT_EQ(reason(time), "") << time;
  EXPECT_NE(reason(9.75).find("0.250000 s younger"), std::string::npos) << reason(9.75);
  EXPECT_NE(reason(10.625).find("mask_max_age"), std::string::npos) << reason(10.625);
  EXPECT_EQ(reason(10.25, TwistHistory()), "no velocity was received yet");
  TwistHistory old;
  old.add({9.5, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  EXPECT_EQ(reason(10.0, old), "") << "a velocity holds for as long as a mask";
  EXPECT_NE(reason(10.25, old).find("0.75 s before"), std::string::npos) << reason(10.25, old);
}

}  // namespace
}  // namespace radar_dot
