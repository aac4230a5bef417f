// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/path_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "radar_dot/simulation/trajectory.h"
#include "simulation/scenarios/path.h"
#include "simulation/scenarios/speed_profile.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.141592653589793;

std::shared_ptr<const Path> leftTurn() {
  return std::make_shared<Path>(
      Path::through({Vector2d(0.0, 0.0), Vector2d(40.0, 0.0), Vector2d(40.0, 80.0)}, 8.0));
}

SpeedProfile brakeAndGo() {
  return SpeedProfileBuilder(0.0, 8.0)
      .keep(1.0)
      .change(4.0, 2.0)
      .keep(6.0)
      .change(0.0, 3.0)
      .keep(3.0)
      .change(9.0, 5.0)
      .build();
}

Vector3d inBody(const Trajectory& trajectory, double time) {
  return trajectory.at(time).T_map_from_body.linear().transpose() * trajectory.velocity(time);
}

double yawRate(const Trajectory& trajectory, double time) { return trajectory.angularVelocity(time).z(); }

TEST(SpeedProfile, ConstantSpeedForAllTimes) {
  const SpeedProfile profile = SpeedProfile::constant(7.0);
  for (const double time : {-100.0, 0.0, 3.5, 1000.0}) {
    EXPECT_DOUBLE_EQ(profile.speed(time), 7.0);
    EXPECT_DOUBLE_EQ(profile.distance(time), 7.0 * time);
    EXPECT_EQ(profile.acceleration(time), 0.0);
  }
}

TEST(SpeedProfile, DistanceIsTheIntegralOfTheSpeedAndSpeedThatOfTheAcceleration) {
  const SpeedProfile profile = brakeAndGo();
  double distance = profile.distance(-2.0);
  double speed = profile.speed(-2.0);
  constexpr double kStep = 1e-3;
  for (double time = -2.0; time < 25.0; time += kStep) {
    distance +=
        kStep *
        (profile.speed(time) + 4.0 * profile.speed(time + 0.5 * kStep) + profile.speed(time + kStep)) / 6.0;
    speed += kStep *
             (profile.acceleration(time) + 4.0 * profile.acceleration(time + 0.5 * kStep) +
              profile.acceleration(time + kStep)) /
             6.0;
    ASSERT_NEAR(profile.distance(time + kStep), distance, 1e-6);
    ASSERT_NEAR(profile.speed(time + kStep), speed, 1e-6);
  }
}

TEST(SpeedProfile, StopsExactlyWhereItShall) {
  const SpeedProfile profile = SpeedProfileBuilder(0.0, 6.0).stopAfter(30.0, 9.0).build();
  EXPECT_NEAR(profile.distance(100.0), 30.0, 1e-12);
  EXPECT_EQ(profile.speed(100.0), 0.0);
  EXPECT_EQ(profile.distance(100.0), profile.distance(8.0));
}

TEST(SpeedProfile, DelayedDoesTheSameLater) {
  const SpeedProfile profile = brakeAndGo();
  const SpeedProfile later = profile.delayed(2.5);
  for (double time = -3.0; time < 30.0; time += 0.37) {
    EXPECT_NEAR(later.speed(time), profile.speed(time - 2.5), 1e-12);
    EXPECT_NEAR(later.distance(time), profile.distance(time - 2.5) - profile.distance(-2.5), 1e-9);
  }
}

TEST(SpeedProfile, RefusesNonsense) {
  EXPECT_THROW(SpeedProfile({}), std::invalid_argument);
  EXPECT_THROW(SpeedProfile({{1.0, 2.0}, {1.0, 3.0}}), std::invalid_argument);
  EXPECT_THROW(SpeedProfile({{1.0, -2.0}}), std::invalid_argument);
}

TEST(Path, ArcOfACircle) {
  Path path(Vector2d(3.0, -2.0), 0.0);
  path.bend(10.0 * kPi, kPi, 0.0);  // half a circle of radius 10
  for (double along = 0.01; along < path.length(); along += 0.31) {
    const PathPoint point = path.at(along);
    EXPECT_NEAR((point.position - Vector2d(3.0, 8.0)).norm(), 10.0, 1e-9);
    EXPECT_NEAR(point.heading, along / 10.0, 1e-12);
    EXPECT_NEAR(point.curvature, 0.1, 1e-12);
  }
}

TEST(Path, PassesTheWaypointsLinesAndIsParametrisedByLength) {
  const auto path = leftTurn();
  constexpr double kStep = 1e-3;
  double before = 0.0;
  for (double along = -5.0; along < path->length() + 5.0; along += 0.01) {
    const PathPoint a = path->at(along);
    const PathPoint b = path->at(along + kStep);
    ASSERT_NEAR((b.position - a.position).norm(), kStep, 1e-8);
    const Vector2d direction = (b.position - a.position) / kStep;
    ASSERT_NEAR(std::atan2(direction.y(), direction.x()), 0.5 * (a.heading + b.heading), 1e-7);
    ASSERT_NEAR((b.heading - a.heading) / kStep, 0.5 * (a.curvature + b.curvature), 1e-5);
    ASSERT_LT(std::abs(a.curvature - before), 0.002) << "curvature jumps at " << along;
    ASSERT_LT(a.curvature, 1.0 / 7.9);
    before = a.curvature;
  }
  EXPECT_NEAR((path->at(path->length()).position - Vector2d(40.0, 80.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(path->at(path->length()).heading, 0.5 * kPi, 1e-12);
}

TEST(PathTrajectory, StraightAtConstantSpeed) {
  const auto path = std::make_shared<Path>(Path::through({Vector2d(0.0, 0.0), Vector2d(30.0, 40.0)}, 5.0));
  const PathTrajectory body(path, SpeedProfile::constant(10.0), {5.0, -1.3, 2.6, 0.0, {}, 0.0});
  for (const double time : {-3.0, 0.0, 2.0, 9.0}) {
    EXPECT_NEAR((body.velocity(time) - Vector3d(6.0, 8.0, 0.0)).norm(), 0.0, 1e-8);
    EXPECT_NEAR(body.angularVelocity(time).norm(), 0.0, 1e-8);
    const Vector3d axle = body.at(time).T_map_from_body * Vector3d(-1.3, 0.0, 0.0);
    EXPECT_NEAR((axle - (5.0 + 10.0 * time) * Vector3d(0.6, 0.8, 0.0)).norm(), 0.0, 1e-9);
  }
}

TEST(PathTrajectory, OnACircleTheYawRateIsSpeedOverRadius) {
  auto path = std::make_shared<Path>(Vector2d::Zero(), 0.4);
  path->bend(40.0, 2.0, 0.0);
  const PathTrajectory body(path, SpeedProfile::constant(5.0), {0.0, 0.0, 2.7, 0.0, {}, 0.0});
  for (const double time : {0.5, 3.0, 7.5}) {
    EXPECT_NEAR(yawRate(body, time), 5.0 / 20.0, 1e-7);
    EXPECT_NEAR(body.at(time).steering_angle, std::atan(2.7 / 20.0), 1e-12);
  }
}

TEST(PathTrajectory, TheRearAxleNeverSlips) {
  const PathTrajectory body(leftTurn(), brakeAndGo(), {10.0, -1.4, 2.8, 0.0, {}, 0.0});
  for (double time = -1.0; time < 25.0; time += 0.05) {
    const Eigen::Isometry3d pose = body.at(time).T_map_from_body;
    const Vector3d lever = pose.linear() * Vector3d(-1.4, 0.0, 0.0);
    const Vector3d axle = body.velocity(time) + body.angularVelocity(time).cross(lever);
    EXPECT_NEAR((pose.linear().transpose() * axle).y(), 0.0, 1e-6);
    EXPECT_NEAR((pose.linear().transpose() * axle).x(), body.at(time).speed, 1e-6);
  }
}

TEST(PathTrajectory, ClimbsAKerbSmoothly) {
  const auto path = std::make_shared<Path>(Path::through({Vector2d(0.0, 0.0), Vector2d(20.0, 0.0)}, 5.0));
  const PathTrajectory walker(path, SpeedProfile::constant(1.4),
                              {0.0, 0.0, 0.0, 0.12, {{5.0, -0.12}, {12.0, 0.12}}, 0.0});
  EXPECT_NEAR(walker.at(0.0).T_map_from_body.translation().z(), 0.12, 1e-12);
  EXPECT_NEAR(walker.at(8.0 / 1.4).T_map_from_body.translation().z(), 0.0, 1e-12);
  EXPECT_NEAR(walker.at(14.0 / 1.4).T_map_from_body.translation().z(), 0.12, 1e-12);
  for (double time = 0.0; time < 12.0; time += 0.01) EXPECT_LT(std::abs(walker.velocity(time).z()), 0.6);
}

TEST(SprungTrajectory, BaseLinkDoesNotSlipAndMovesSmoothly) {
  const SprungTrajectory ego(leftTurn(), brakeAndGo(), 10.0, 3);
  constexpr double kStep = 0.01;
  Vector3d acceleration_before = Vector3d::Zero();
  for (double time = -2.0; time < 25.0; time += kStep) {
    const Vector3d velocity = inBody(ego, time);
    ASSERT_NEAR(velocity.x(), ego.at(time).speed, 0.03);
    ASSERT_NEAR(velocity.y(), 0.0, 0.004);
    const Vector3d acceleration = (ego.velocity(time + kStep) - ego.velocity(time - kStep)) / (2.0 * kStep);
    ASSERT_LT(acceleration.head<2>().norm(), 5.0) << "at " << time;
    if (time > -2.0) {
      ASSERT_LT((acceleration - acceleration_before).norm() / kStep, 15.0) << "at " << time;
    }
    acceleration_before = acceleration;
    const Vector3d turn =
        (ego.angularVelocity(time + kStep) - ego.angularVelocity(time - kStep)) / (2.0 * kStep);
    ASSERT_LT(turn.norm(), 3.0) << "at " << time;
  }
}

TEST(SprungTrajectory, DivesWhenItBrakesLeansOutInATurnAndIsQuietWhenItStands) {
  const SprungTrajectory ego(leftTurn(), brakeAndGo(), 10.0, 3);
  const auto noseDown = [&](double time) { return -ego.at(time).T_map_from_body.linear()(2, 0); };
  EXPECT_GT(noseDown(10.9), 0.008);
  const double bend = 5.0;  // about 30 m on: in the turn
  EXPECT_GT(ego.at(bend).T_map_from_body.linear()(2, 1), 0.005) << "the left side rises in a left turn";
  for (double time = 13.8; time < 14.9; time += 0.1) {
    EXPECT_LT(ego.velocity(time).norm(), 1e-9);
    EXPECT_LT(ego.angularVelocity(time).norm(), 1e-3);
  }
}

TEST(SprungTrajectory, TheRoadShakesItByTenthsOfADegree) {
  const auto path = std::make_shared<Path>(Path::through({Vector2d(0.0, 0.0), Vector2d(900.0, 0.0)}, 5.0));
  const SprungTrajectory ego(path, SpeedProfile::constant(12.0), 0.0, 11);
  double sum = 0.0;
  int count = 0;
  for (double time = 0.0; time < 60.0; time += 0.05, ++count)
    sum += std::pow(ego.at(time).T_map_from_body.linear()(2, 0) * 180.0 / kPi, 2);
  const double deviation = std::sqrt(sum / count);
  EXPECT_GT(deviation, 0.08);
  EXPECT_LT(deviation, 0.2);
}

}  // namespace
}  // namespace radar_dot::simulation
