// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/mount_geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

MountGeometry assess(const std::vector<Eigen::Isometry3d>& mounts, MotionModel model) {
  EgoVelocityParams params;
  params.model = model;
  return assessMounts(mounts, params);
}

TEST(MountGeometry, RadarsAroundACarTellEverything) {
  for (const MotionModel model : {MotionModel::kPlanarYaw, MotionModel::kAckermann}) {
    const MountGeometry geometry = assess(test::carMounts(), model);
    EXPECT_LT(geometry.vx_std, 0.06);
    EXPECT_LT(geometry.yaw_rate_std, 0.03);
    EXPECT_EQ(geometry.advice, "");
  }
}

// Noise of the scan alone: two scans that see the same velocity with an error s each, at a distance b along
// the vehicle, tell the yaw rate to sqrt(2) s / b.
TEST(MountGeometry, TheYawRateIsAsGoodAsTheDistanceOfTheMounts) {
  EgoVelocityParams params;
  params.noise.doppler_std = 1e-3;
  const auto std = [&](double distance) {
    // Bearings within a narrow beam to the left: each scan sees vy alone.
    return assessMounts({test::mount(0.0, 0.0, 0.0, M_PI / 2), test::mount(distance, 0.0, 0.0, M_PI / 2),
                         test::mount(0.0, 0.0, 0.0, 0.0)},
                        params, 1e-6)
        .yaw_rate_std;
  };
  EXPECT_NEAR(std(2.0), std::sqrt(2.0) * params.scan_std / 2.0, 1e-4);
  EXPECT_NEAR(std(4.0), std::sqrt(2.0) * params.scan_std / 4.0, 1e-4);
}

TEST(MountGeometry, RadarsAtTheFrontNeedAnotherModel) {
  const std::vector<Eigen::Isometry3d> front = {test::mount(3.4, 0.2, 0.5, 0.5),
                                                test::mount(3.4, -0.2, 0.5, -0.5)};
  const MountGeometry geometry = assess(front, MotionModel::kPlanarYaw);
  EXPECT_GT(geometry.yaw_rate_std, 0.1);
  EXPECT_EQ(geometry.advice.rfind("all radars sit within 0.4 m of one another: planar_yaw cannot tell", 0),
            0U)
      << geometry.advice;
  EXPECT_NE(geometry.advice.find("model: ackermann"), std::string::npos) << geometry.advice;
  EXPECT_EQ(assess(front, MotionModel::kAckermann).advice, "");

  const MountGeometry one = assess({front[0]}, MotionModel::kPlanarYaw);
  EXPECT_TRUE(std::isinf(one.yaw_rate_std));
  EXPECT_EQ(one.advice.rfind("there is one radar", 0), 0U) << one.advice;
}

TEST(MountGeometry, ARadarAboveTheRearAxleTellsNoYawRate) {
  const MountGeometry geometry = assess({test::mount(0.0, 0.0, 1.5, 0.0)}, MotionModel::kAckermann);
  EXPECT_TRUE(std::isinf(geometry.yaw_rate_std));
  EXPECT_LT(geometry.vx_std, 0.1);
  EXPECT_NE(geometry.advice.find("rotation_source"), std::string::npos) << geometry.advice;
}

TEST(MountGeometry, ModelsWithoutAYawRateNeedNoAdvice) {
  const MountGeometry geometry = assess({test::mount(3.4, 0.0, 0.5, 0.0)}, MotionModel::kPlanar);
  EXPECT_TRUE(std::isinf(geometry.yaw_rate_std));
  EXPECT_LT(geometry.vy_std, 0.2);
  EXPECT_EQ(geometry.advice, "");
}

}  // namespace
}  // namespace radar_dot
