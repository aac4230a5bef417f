// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/twist_uncertainty.h"

#include <gtest/gtest.h>

namespace radar_dot {
namespace {

TEST(MotionUncertainty, OfATwistThatIsLessCertainThanConfigured) {
  MotionUncertainty configured;
  configured.forward_velocity_std = 0.1;
  configured.lateral_velocity_std = 0.06;
  configured.yaw_rate_std = 0.006;
  geometry_msgs::TwistWithCovariance::_covariance_type covariance{};
  covariance[0] = 0.25 * 0.25;
  covariance[7] = 1e6;  // not observed
  covariance[35] = 0.02 * 0.02;
  const MotionUncertainty wide = motionUncertainty(configured, covariance, /*has_rotation=*/false);
  EXPECT_NEAR(wide.forward_velocity_std, 0.25, 1e-12);
  EXPECT_EQ(wide.lateral_velocity_std, 0.06);
  EXPECT_NEAR(wide.yaw_rate_std, 0.02, 1e-12);
  EXPECT_EQ(motionUncertainty(configured, covariance, /*has_rotation=*/true).yaw_rate_std, 0.006);
  covariance[0] = 0.05 * 0.05;
  EXPECT_EQ(motionUncertainty(configured, covariance, false).forward_velocity_std, 0.1);
}

}  // namespace
}  // namespace radar_dot
