// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/moment.h"

#include <gtest/gtest.h>

namespace radar_dot {
namespace {

TEST(Moment, WaitsByTheSlowerClockButNotForEver) {
  constexpr double kTimeout = 0.25;
  const Moment arrival{100.0, 5000.0};
  EXPECT_TRUE(arrival.waits(kTimeout, {100.2, 5002.0})) << "a replay at a tenth of the speed";
  EXPECT_TRUE(arrival.waits(kTimeout, {100.3, 5000.06})) << "at five times the speed computing takes as long";
  EXPECT_FALSE(arrival.waits(kTimeout, {101.3, 5000.26}));
  EXPECT_TRUE((Moment{0.0, 5000.0}.waits(kTimeout, {1.7e9, 5000.1}))) << "the clock of ROS began meanwhile";
  EXPECT_TRUE(arrival.waits(kTimeout, {100.0, 5004.9})) << "the clock stands still, perhaps for a moment";
  EXPECT_FALSE(arrival.waits(kTimeout, {100.0, 5005.1}));
  EXPECT_FALSE(arrival.waits(0.0, arrival));
}

}  // namespace
}  // namespace radar_dot
