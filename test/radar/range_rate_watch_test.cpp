// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/range_rate_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

using Verdict = RangeRateWatch::Verdict;

constexpr double kPeriod = 0.075;  // s

/// A street with things at both sides, some of which move, and a radar that drives along it.
class Street {
 public:
  double speed = 15.0;         // m/s, of the vehicle
  std::size_t movers = 0;      // of the things, at 10 m/s ahead
  bool has_guardrail = false;  // a post every 2 m
  /// What becomes of the true range rate.
  std::function<float(float doppler, float ground_rate)> rate = [](float doppler, float) { return doppler; };

  RangeRateWatch watch(double seconds) {
    std::uniform_real_distribution<double> along(0.0, 400.0), across(3.0, 25.0);
    std::vector<Eigen::Vector2d> things;
    for (int i = 0; i < 250; ++i)
      things.emplace_back(along(random_), (i % 2 == 0 ? 1.0 : -1.0) * across(random_));
    for (int i = 0; has_guardrail && i < 200; ++i) things.emplace_back(2.0 * i, 6.0);
    const Eigen::Isometry3d mount = test::mount(3.0, 0.4, 0.5, 0.2);
    RangeRateWatch watch;
    for (double time = 0.0; time < seconds; time += kPeriod) {
      std::vector<DopplerReturn> scan;
      for (std::size_t i = 0; i < things.size(); ++i) {
        const double own = i < movers ? 10.0 : 0.0;
        const Eigen::Vector3d thing(things[i].x() + own * time - speed * time, things[i].y(), 0.5);
        addReturn(mount.inverse() * thing, mount.linear().transpose() * Eigen::Vector3d::UnitX(), own, scan);
      }
      watch.add(time, scan, mount);
    }
    return watch;
  }

 private:
  void addReturn(const Eigen::Vector3d& thing, const Eigen::Vector3d& ahead, double own,
                 std::vector<DopplerReturn>& scan) {
    const double range = thing.norm(), azimuth = std::atan2(thing.y(), thing.x());
    if (range > 70.0 || std::abs(azimuth) > 1.0 || noise_(random_) > 0.5) return;  // two in three are seen
    DopplerReturn seen;
    const double measured = azimuth + 0.01 * noise_(random_);
    seen.bearing = Eigen::Vector3d(std::cos(measured), std::sin(measured), 0.0).cast<float>();
    seen.range = static_cast<float>(range + 0.15 * noise_(random_));
    const double along = ahead.dot(thing) / range;
    seen.doppler = rate(static_cast<float>(along * (own - speed) + 0.05 * noise_(random_)),
                        static_cast<float>(along * own + 0.05 * noise_(random_)));
    scan.push_back(seen);
  }

  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0.0, 1.0};
};

TEST(RangeRateWatch, TrueRangeRatesAreGood) {
  for (const double speed : {0.0, 0.3, 3.0, 15.0, 30.0}) {
    for (const std::size_t movers : {0U, 60U}) {
      for (const bool has_guardrail : {false, true}) {
        Street street;
        street.speed = speed;
        street.movers = movers;
        street.has_guardrail = has_guardrail;
        const RangeRateWatch watch = street.watch(8.0);
        EXPECT_EQ(watch.verdict(), Verdict::kGood)
            << speed << " " << movers << " " << watch.warning("field 'v'");
      }
    }
  }
}

TEST(RangeRateWatch, RangeRatesOfZeroWhileTheReturnsComeNearer) {
  for (const double speed : {6.0, 15.0, 25.0}) {
    Street street;
    street.speed = speed;
    street.rate = [](float, float) { return 0.F; };
    const RangeRateWatch watch = street.watch(8.0);
    EXPECT_EQ(watch.verdict(), Verdict::kStill) << speed;
    EXPECT_NEAR(watch.value(), speed, 1.5);
    EXPECT_EQ(watch.warning("field 'v'").rfind("by field 'v' nothing moves", 0), 0U);
  }
}

TEST(RangeRateWatch, CompensatedRangeRates) {
  Street street;
  street.movers = 40;
  street.rate = [](float, float ground_rate) { return ground_rate; };
  EXPECT_EQ(street.watch(8.0).verdict(), Verdict::kStill);
}

TEST(RangeRateWatch, OneVelocityOfAllReturns) {
  Street street;
  street.rate = [](float, float) { return 5.F; };
  const RangeRateWatch watch = street.watch(4.0);
  EXPECT_EQ(watch.verdict(), Verdict::kConstant);
  EXPECT_NE(watch.warning("field 'v'").find("5.00 m/s"), std::string::npos) << watch.warning("field 'v'");
  street.rate = [](float, float) { return -0.5F; };
  EXPECT_EQ(street.watch(4.0).verdict(), Verdict::kGood) << "creeping, with a coarse radar";
}

}  // namespace
}  // namespace radar_dot
