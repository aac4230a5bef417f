// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/yaw_rate_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace radar_dot {
namespace {

using Verdict = YawRateComparison::Verdict;

/// Bends of either side, as in a town.
double drive(double time) { return 0.3 * std::sin(0.6 * time); }

/// @param seconds  of readings at 13 Hz with noise
YawRateComparison compare(double seconds, const std::function<double(double)>& rate,
                          const std::function<double(double)>& reference = drive) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.02);
  YawRateComparison comparison;
  for (double time = 0.0; time < seconds; time += 0.075)
    comparison.add(time, rate(time) + noise(random), 0.02, reference(time));
  return comparison;
}

TEST(YawRateComparison, RatesThatAgreeBarADelayAreGood) {
  for (double seconds = 1.0; seconds < 30.0; seconds += 1.0) {
    const YawRateComparison late = compare(seconds, [](double time) { return drive(time - 0.15); });
    EXPECT_EQ(late.verdict(), Verdict::kAgree) << seconds << ": " << late.difference();
    EXPECT_EQ(late.warning("ego/twist", "the IMU"), "");
  }
}

TEST(YawRateComparison, TellsTheLikelyCause) {
  EXPECT_EQ(compare(15.0, [](double time) { return -drive(time); }).verdict(), Verdict::kOpposite);
  EXPECT_EQ(compare(15.0, drive, [](double time) { return 57.3 * drive(time); }).verdict(),
            Verdict::kDegrees);
  EXPECT_EQ(compare(15.0, [](double time) { return 0.4 * drive(time); }).verdict(), Verdict::kFactor);
  EXPECT_EQ(compare(15.0, [](double time) { return drive(time) + 0.12; }).verdict(), Verdict::kOffset);
}

// A bend in which the image turns by 0.28 rad/s and the radar says 0.08, as one radar model does.
TEST(YawRateComparison, NamesABendThatOneOfThemDoesNotSee) {
  const auto bend = [](double time) { return time > 5.0 ? 1.0 : 0.0; };
  const auto radar = [&](double time) { return 0.08 * bend(time); };
  const auto image = [&](double time) { return 0.28 * bend(time); };
  EXPECT_EQ(compare(5.5, radar, image).verdict(), Verdict::kAgree);
  const YawRateComparison comparison = compare(11.0, radar, image);
  EXPECT_EQ(comparison.verdict(), Verdict::kFactor);
  const std::string text = comparison.warning("ego/twist", "the image");
  EXPECT_EQ(text.rfind("ego/twist turns by 0.07 rad/s, the image by 0.2", 0), 0U) << text;
}

TEST(YawRateComparison, ForgetsAfterAGap) {
  YawRateComparison comparison = compare(10.0, [](double time) { return drive(time) + 0.3; });
  ASSERT_NE(comparison.verdict(), Verdict::kAgree);
  comparison.add(20.0, 0.0, 0.02, 0.0);
  EXPECT_EQ(comparison.verdict(), Verdict::kAgree);
}

TEST(YawRateComparison, AContradictionExpiresWithItsReadings) {
  YawRateComparison comparison;
  for (int i = 0; i < 100; ++i) comparison.add(0.1 * i, 0.1, 0.005, 0.4);
  ASSERT_NE(comparison.verdict(), YawRateComparison::Verdict::kAgree);
  comparison.expire(10.5);
  EXPECT_NE(comparison.verdict(), YawRateComparison::Verdict::kAgree);
  comparison.expire(13.0);
  EXPECT_EQ(comparison.verdict(), YawRateComparison::Verdict::kAgree);
}

}  // namespace
}  // namespace radar_dot
