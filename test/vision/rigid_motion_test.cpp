// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/rigid_motion.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "fixtures/camera_mount.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(BaseMotion, StraightIsVelocityTimesTime) {
  const Eigen::Isometry3d motion = baseMotion({10.0, 1.0, 0.0}, Eigen::Vector3d::Zero(), 0.5);
  EXPECT_TRUE(motion.translation().isApprox(Eigen::Vector3d(5.0, 0.5, 0.0)));
  EXPECT_TRUE(motion.linear().isIdentity());
}

// A quarter of a circle of radius 10 m to the left ends 10 m ahead and 10 m to the left, facing left.
TEST(BaseMotion, TurnsAlongAnArc) {
  const double duration = 4.0;
  const Eigen::Isometry3d motion = baseMotion({10.0 * kPi / 2.0 / duration, 0.0, 0.0},
                                              Eigen::Vector3d(0.0, 0.0, kPi / 2.0 / duration), duration);
  EXPECT_TRUE(motion.translation().isApprox(Eigen::Vector3d(10.0, 10.0, 0.0), 1e-9));
  EXPECT_TRUE((motion.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-9));
}

TEST(BaseMotion, TinyTurnsAreContinuous) {
  const Eigen::Vector3d v(10.0, 0.0, 0.0);
  const Eigen::Isometry3d below = baseMotion(v, Eigen::Vector3d(0.0, 0.0, 0.999e-4), 1.0);
  const Eigen::Isometry3d above = baseMotion(v, Eigen::Vector3d(0.0, 0.0, 1.001e-4), 1.0);
  EXPECT_NEAR((below.translation() - above.translation()).norm(), 0.5 * 10.0 * 0.002e-4, 1e-9);
}

/// A camera 1.7 m ahead of the base and 1.5 m up, looking ahead: x right = -y, y down = -z, z ahead = x.
Eigen::Isometry3d frontCamera() { return test::lookingAhead({1.7, 0.0, 1.5}); }

TEST(BaseVelocity, IsTheInverseOfTheMotion) {
  for (const double dt : {0.5, -0.08}) {
    const Eigen::Vector3d linear(9.0, -0.4, 0.1);
    const Eigen::Vector3d angular(0.02, -0.05, 0.6);
    const StampedTwist found = baseVelocity(baseMotion(linear, angular, dt), dt);
    EXPECT_LT((found.linear - linear).norm(), 1e-9);
    EXPECT_LT((found.angular - angular).norm(), 1e-9);
  }
  EXPECT_LT((baseVelocity(baseMotion({3.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.1), 0.1).linear -
             Eigen::Vector3d(3.0, 0.0, 0.0))
                .norm(),
            1e-9);
  EXPECT_THROW(baseVelocity(Eigen::Isometry3d::Identity(), 0.0), std::invalid_argument);
}

TEST(StaticPointMotion, DrivingAheadBringsPointsNearer) {
  const Eigen::Isometry3d motion =
      staticPointMotion(frontCamera(), baseMotion({10.0, 0.0, 0.0}, Eigen::Vector3d::Zero(), 0.5));
  EXPECT_TRUE((motion * Eigen::Vector3d(1.0, 0.5, 20.0)).isApprox(Eigen::Vector3d(1.0, 0.5, 15.0)));
}

// Turning on the spot to the left by a right angle: a point 10 m to the left of the rear axle, level with
// the camera, is dead ahead afterwards, and nearer by the lever arm.
TEST(StaticPointMotion, KnowsTheLeverArm) {
  const Eigen::Isometry3d motion = staticPointMotion(
      frontCamera(), baseMotion(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, kPi / 2.0), 1.0));
  const Eigen::Vector3d before = frontCamera().inverse() * Eigen::Vector3d(0.0, 10.0, 1.5);
  EXPECT_TRUE((motion * before).isApprox(Eigen::Vector3d(0.0, 0.0, 10.0 - 1.7), 1e-9));
}

TEST(StaticPointMotion, AgreesWithPosesInTheWorld) {
  Eigen::Isometry3d first = Eigen::Isometry3d::Identity();
  first.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, -0.05, 1.0).normalized()).toRotationMatrix();
  first.translation() = Eigen::Vector3d(100.0, -40.0, 2.0);
  Eigen::Isometry3d second = Eigen::Isometry3d::Identity();
  second.linear() = Eigen::AngleAxisd(0.9, Eigen::Vector3d(-0.1, 0.02, 1.0).normalized()).toRotationMatrix();
  second.translation() = Eigen::Vector3d(103.0, -37.0, 2.1);
  const Eigen::Vector3d point(120.0, -20.0, 3.0);  // in the world, standing
  const Eigen::Vector3d seen_first = (first * frontCamera()).inverse() * point;
  const Eigen::Vector3d seen_second = (second * frontCamera()).inverse() * point;
  const Eigen::Isometry3d motion = staticPointMotion(frontCamera(), first.inverse() * second);
  EXPECT_TRUE((motion * seen_first).isApprox(seen_second, 1e-9));
}

TEST(CameraIntrinsics, ScalingKeepsTheBordersOfTheImage) {
  const CameraIntrinsics camera{1266.0, 1266.0, 816.0, 491.0, 1600, 900};
  const CameraIntrinsics half = camera.scaledTo(800, 450);
  const Eigen::Vector3d ray = camera.rayOf(-0.5, 899.5);
  const Eigen::Vector2d corner = half.project(ray);
  EXPECT_NEAR(corner.x(), -0.5, 1e-9);
  EXPECT_NEAR(corner.y(), 449.5, 1e-9);
  EXPECT_TRUE(CameraIntrinsics::fromMatrix(camera.matrix(), 1600, 900).matrix().isApprox(camera.matrix()));
}

TEST(CameraIntrinsics, RefusesNonsense) {
  EXPECT_THROW(CameraIntrinsics::fromMatrix(Eigen::Matrix3d::Zero(), 1600, 900), std::invalid_argument);
  EXPECT_THROW(CameraIntrinsics::fromMatrix(Eigen::Matrix3d::Identity(), 0, 900), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot
