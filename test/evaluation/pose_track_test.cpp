// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/pose_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

Eigen::Isometry3d pose(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// An arc of radius v / w around (0, v / w), 20 Hz, 10 s.
PoseTrack arc(double v, double w) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.05 * i;
    poses.emplace_back(t, pose(v / w * std::sin(w * t), v / w * (1.0 - std::cos(w * t)), w * t));
  }
  return PoseTrack(std::move(poses));
}

TEST(PoseTrack, InterpolatesAndExtrapolates) {
  const PoseTrack track({{0.0, pose(0.0, 0.0, 0.0)}, {1.0, pose(8.0, 0.0, 0.2)}});
  EXPECT_NEAR(track.at(0.25).translation().x(), 2.0, 1e-12);
  EXPECT_NEAR(std::atan2(track.at(0.5).linear()(1, 0), track.at(0.5).linear()(0, 0)), 0.1, 1e-12);
  EXPECT_NEAR(track.at(-0.1).translation().x(), -0.8, 1e-12);
  EXPECT_NEAR(track.at(1.1).translation().x(), 8.8, 1e-12);
  EXPECT_NEAR(std::atan2(track.at(1.5).linear()(1, 0), track.at(1.5).linear()(0, 0)), 0.3, 1e-12);
  EXPECT_EQ(track.at(0.0).translation().x(), 0.0);
  EXPECT_EQ(track.at(1.0).translation().x(), 8.0);
}

// On an arc the chord is parallel to the velocity at its middle and shorter than the arc by sinc(w T / 2).
TEST(PoseTrack, MeanVelocityOfATurnPointsForward) {
  const double v = 6.0, w = 0.4;
  const PoseTrack track = arc(v, w);
  const Eigen::Vector3d mean = track.meanVelocity(3.0, 3.5);
  EXPECT_NEAR(mean.x(), v * std::sin(w * 0.25) / (w * 0.25), 1e-3);
  EXPECT_NEAR(mean.y(), 0.0, 1e-3);
  EXPECT_NEAR(track.meanYawRate(3.0, 3.5), w, 1e-9);
}

TEST(PoseTrack, BadInputIsRefused) {
  EXPECT_THROW(PoseTrack({{0.0, pose(0, 0, 0)}}), std::invalid_argument);
  EXPECT_THROW(PoseTrack({{0.0, pose(0, 0, 0)}, {0.0, pose(1, 0, 0)}}), std::invalid_argument);
}

TEST(TrajectoryErrors, KnownDrift) {
  const PoseTrack truth({{0.0, pose(0.0, 0.0, 0.0)}, {10.0, pose(100.0, 0.0, 0.0)}});
  std::vector<StampedPose> estimate;
  for (int i = 0; i <= 10; ++i)
    estimate.emplace_back(1.0 * i, pose(10.0 * i, 0.1 * i, 0.0));  // 1 % to the side
  const TrajectoryError error = compareTrajectory(estimate, truth);
  EXPECT_NEAR(error.driftPercent(), 1.0, 1e-9);
  double squares = 0.0;
  for (int i = 0; i <= 10; ++i) squares += 0.01 * i * i;
  EXPECT_NEAR(error.rootMeanSquare(), std::sqrt(squares / 11), 1e-9);
  EXPECT_NEAR(error.distance, 100.0, 1e-9);
  TrajectoryError twice = error;
  twice += error;
  EXPECT_NEAR(twice.driftPercent(), 1.0, 1e-9);
  EXPECT_NEAR(twice.rootMeanSquare(), error.rootMeanSquare(), 1e-9);
  EXPECT_TRUE(std::isnan(TrajectoryError{}.driftPercent()));
  EXPECT_TRUE(std::isnan(TrajectoryError{}.rootMeanSquare()));
}

}  // namespace
}  // namespace radar_dot::evaluation
