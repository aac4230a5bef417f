// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/pose_buffer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace radar_dot {
namespace {

StampedPose sampleAt(double time, double yaw, double x) {
  StampedPose sample;
  sample.time = time;
  sample.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  sample.position = {x, 0.0, 0.0};
  return sample;
}

double yawOf(const Eigen::Quaterniond& q) { return 2.0 * std::atan2(q.z(), q.w()); }

TEST(PoseBuffer, InterpolatesLinearlyAndAlongTheShortArc) {
  PoseBuffer buffer;
  buffer.add(sampleAt(1.0, 0.2, 10.0));
  buffer.add(sampleAt(1.1, 0.6, 11.0));
  const auto pose = buffer.at(1.025);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(yawOf(pose->rotation), 0.3, 1e-9);
  EXPECT_NEAR(pose->position.x(), 10.25, 1e-9);
  EXPECT_NEAR(yawOf(buffer.at(1.1)->rotation), 0.6, 1e-9) << "a sample's own time needs no neighbour";

  PoseBuffer across;
  across.add(sampleAt(1.0, 3.1, 0.0));
  across.add(sampleAt(1.1, 3.1 + 0.2, 0.0));
  EXPECT_NEAR(std::remainder(yawOf(across.at(1.05)->rotation) - 3.2, 2.0 * M_PI), 0.0, 1e-9);
}

TEST(PoseBuffer, KnowsNothingOutsideItsSamplesOrAcrossAGap) {
  PoseBuffer buffer(5.0, 100, 0.5);
  EXPECT_FALSE(buffer.at(1.0));
  EXPECT_FALSE(buffer.latest());
  buffer.add(sampleAt(1.0, 0.0, 0.0));
  buffer.add(sampleAt(1.1, 0.0, 0.0));
  buffer.add(sampleAt(2.0, 0.0, 0.0));
  EXPECT_FALSE(buffer.at(0.99));
  EXPECT_FALSE(buffer.at(2.01));
  EXPECT_FALSE(buffer.at(1.5)) << "0.9 s without a sample";
  EXPECT_TRUE(buffer.at(1.05));
}

TEST(PoseBuffer, IsBoundedInTimeAndNumber) {
  PoseBuffer buffer(1.0, 4, 10.0);
  for (int i = 0; i < 10; ++i) buffer.add(sampleAt(0.1 * i, 0.0, 0.0));
  EXPECT_FALSE(buffer.at(0.55)) << "four samples reach back to 0.6 s";
  EXPECT_TRUE(buffer.at(0.65));
  buffer.add(sampleAt(1.9, 0.0, 0.0));
  EXPECT_FALSE(buffer.at(0.85)) << "older than a second";
}

TEST(PoseBuffer, OnlyLaterPosesAreTaken) {
  PoseBuffer buffer;
  for (const double time : {5.0, 4.9, 5.0}) buffer.add(sampleAt(time, 0.0, time));
  EXPECT_EQ(*buffer.latest(), 5.0);
  EXPECT_FALSE(buffer.at(4.95));
  buffer.clear();
  buffer.add(sampleAt(1.0, 0.0, 0.0));
  EXPECT_EQ(*buffer.latest(), 1.0) << "time may be reset";
}

TEST(AttitudeIntegrator, IsExactForALinearYawRateAndStartsAnewAfterAGap) {
  AttitudeIntegrator integrator(0.5);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_TRUE(integrator.add(0.0, {0.3, -0.4, 0.0}, none));
  for (int i = 1; i <= 100; ++i) EXPECT_FALSE(integrator.add(0.01 * i, {0.3, -0.4, 0.2 * 0.01 * i}, none));
  EXPECT_NEAR(yawOf(integrator.attitude()), 0.1, 1e-12) << "0.2 t integrated over one second";
  EXPECT_NEAR(integrator.attitude().vec().head<2>().norm(), 0.0, 1e-12)
      << "without gravity nothing holds roll and pitch: the heading alone";
  EXPECT_FALSE(integrator.isLevel());
  EXPECT_TRUE(integrator.add(2.0, {0.0, 0.0, 0.3}, none));
  EXPECT_EQ(yawOf(integrator.attitude()), 0.0);
}

TEST(AttitudeIntegrator, StartsLevelAndFollowsEveryAxis) {
  const Eigen::Quaterniond tilted =
      Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d up(0.0, 0.0, AttitudeIntegrator::kGravity), rate(0.5, -0.3, 0.8);
  AttitudeIntegrator integrator;
  for (int i = 0; i <= 100; ++i) {
    const Eigen::AngleAxisd turn(0.01 * i * rate.norm(), rate.normalized());
    integrator.add(0.01 * i, rate, (tilted * turn).conjugate() * up);
    EXPECT_NEAR((integrator.attitude() * ((tilted * turn).conjugate() * up) - up).norm(), 0.0, 1e-9);
  }
  EXPECT_TRUE(integrator.isLevel());
}

TEST(HeadingOf, DropsRollAndPitch) {
  const Eigen::Quaterniond tilted = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(yawOf(headingOf(tilted)), 0.7, 1e-12);
  EXPECT_NEAR(headingOf(tilted).x(), 0.0, 1e-12);
}

}  // namespace
}  // namespace radar_dot
