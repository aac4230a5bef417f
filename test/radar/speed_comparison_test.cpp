// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/speed_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace radar_dot {
namespace {

using Verdict = SpeedComparison::Verdict;

/// Town traffic between 0 and 15 m/s, braking by up to 3 m/s^2.
double drive(double time) { return 7.5 - 7.5 * std::cos(0.4 * time); }

SpeedComparison compare(double seconds, const std::function<double(double)>& speed,
                        const std::function<double(double)>& reference = drive) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.1);
  SpeedComparison comparison;
  for (double time = 0.0; time < seconds; time += 0.075)
    comparison.add(time, speed(time) + noise(random), reference(time));
  return comparison;
}

TEST(SpeedComparison, SpeedsThatAgreeBarADelayAndAScaleAreGood) {
  for (double seconds = 1.0; seconds < 40.0; seconds += 1.0) {
    const SpeedComparison late =
        compare(seconds, [](double time) { return 0.95 * drive(std::max(0.0, time - 0.3)); });
    EXPECT_EQ(late.verdict(), Verdict::kAgree) << seconds;
    EXPECT_EQ(late.warning("ego/twist", "TF", "the range rates"), "");
  }
}

TEST(SpeedComparison, TellsTheLikelyCause) {
  const SpeedComparison zero = compare(10.0, [](double) { return 0.0; });
  EXPECT_EQ(zero.verdict(), Verdict::kStands);
  const std::string text = zero.warning("ego/twist", "TF", "the range rates");
  EXPECT_NE(text.find("the range rates are zero, constant, or compensated"), std::string::npos) << text;
  EXPECT_EQ(compare(10.0, drive, [](double) { return 0.0; }).verdict(), Verdict::kReferenceStands);
  EXPECT_EQ(compare(10.0, [](double time) { return -drive(time); }).verdict(), Verdict::kOpposite);
  const SpeedComparison hourly = compare(10.0, [](double time) { return 3.6 * drive(time); });
  EXPECT_EQ(hourly.verdict(), Verdict::kFactor);
  EXPECT_NE(hourly.warning("a", "b", "c").find("a factor of 3.6"), std::string::npos);
  EXPECT_EQ(compare(
                1.5, [](double) { return 9.0; }, [](double) { return 0.0; })
                .verdict(),
            Verdict::kAgree)
      << "nothing is told of a moment";
}

TEST(SpeedComparison, ForgetsAfterAGapAndLeavesNonsenseOut) {
  SpeedComparison comparison = compare(10.0, [](double) { return 0.0; });
  comparison.add(10.0, std::numeric_limits<double>::quiet_NaN(), 1.0);
  comparison.add(10.1, 1.0, std::numeric_limits<double>::infinity());
  EXPECT_EQ(comparison.verdict(), Verdict::kStands);
  comparison.expire(13.0);
  EXPECT_EQ(comparison.verdict(), Verdict::kAgree);
}

}  // namespace
}  // namespace radar_dot
