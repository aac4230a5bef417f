// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/radar_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

using Verdict = RadarAgreement::Verdict;

constexpr double kPeriod = 0.075;  // s
constexpr double kDegree = 0.017453292519943295;

const std::vector<RadarAgreement::Radar> kCar = {
    {"front"}, {"left"}, {"right"}, {"rear_left"}, {"rear_right"}};

/// A drive with gentle bends, a fifth of the returns moving, and what the agreement says of it.
class Drive {
 public:
  explicit Drive(std::vector<RadarAgreement::Radar> of_radars = kCar,
                 std::vector<Eigen::Isometry3d> at = test::carMounts())
      : radars(std::move(of_radars)), mounts(std::move(at)), agreement(radars) {}

  /// @param spoil  makes the fault
  void go(double seconds, const std::function<void(std::vector<RadarScan>&, test::Sweep&)>& spoil = {}) {
    for (const double end = time + seconds; time < end; time += kPeriod) {
      test::SweepOptions options;
      options.seed = seed++;
      options.moving_share = 0.2;
      options.doppler_sigma = 0.12;
      options.azimuth_sigma = 0.015;
      test::Sweep sweep =
          test::makeSweep(mounts, {speed, 0.0, 0.0}, {0.0, 0.0, 0.15 * std::sin(0.5 * time)}, options);
      std::vector<RadarScan> scans = sweep.scans();
      for (RadarScan& scan : scans) scan.time = time;
      if (spoil) spoil(scans, sweep);
      const EgoVelocityResult result = estimator.estimate(scans, time);
      agreement.add(time, scans, result, estimator.params());
    }
  }
  void expectGood(std::size_t except = 99) const {
    for (std::size_t i = 0; i < radars.size(); ++i) {
      if (i == except) continue;
      EXPECT_EQ(agreement.figures(i).verdict, Verdict::kGood) << agreement.figures(i).warning;
      EXPECT_EQ(agreement.figures(i).warning, "");
    }
    EXPECT_EQ(agreement.warning(), "");
  }
  const RadarAgreement::Figures& of(std::size_t radar) const { return agreement.figures(radar); }

  std::vector<RadarAgreement::Radar> radars;
  std::vector<Eigen::Isometry3d> mounts;
  EgoVelocityEstimator estimator;
  RadarAgreement agreement;
  double speed = 10.0;
  double time = 0.0;
  std::uint32_t seed = 1;
};

void turn(RadarScan& scan, double yaw) {
  scan.T_base_from_sensor.linear() =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * scan.T_base_from_sensor.linear();
}

auto turned(std::size_t radar, double yaw) {
  return [=](std::vector<RadarScan>& scans, test::Sweep&) { turn(scans[radar], yaw); };
}

auto reversed(std::size_t radar) {
  return [=](std::vector<RadarScan>&, test::Sweep& sweep) {
    for (DopplerReturn& each : sweep.returns[radar]) each.doppler = -each.doppler;
  };
}

TEST(RadarAgreement, RadarsWithoutAFaultAreGood) {
  Drive drive;
  for (int i = 0; i < 8; ++i) {
    drive.go(5.0);
    drive.expectGood();
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(drive.of(i).returns, 60.0, 1e-9);
    EXPECT_NEAR(drive.of(i).inlier_share, 0.75, 0.1);
    EXPECT_NEAR(drive.of(i).median_residual, 0.12, 0.06);
    EXPECT_NEAR(drive.of(i).yaw_correction, 0.0, 0.5 * kDegree);
    EXPECT_LT(drive.of(i).yaw_std, 0.4 * kDegree);
  }
}

// The mount in TF is turned to the left by 3 degrees: the correction turns it to the right.
TEST(RadarAgreement, NamesTheRadarWhoseMountIsTurned) {
  for (std::size_t radar = 0; radar < 5; ++radar) {
    for (const double yaw : {3.0 * kDegree, -6.0 * kDegree, 12.0 * kDegree}) {
      Drive drive;
      drive.radars[radar].mount_yaw_correction = 0.1;
      drive.agreement.configure(drive.radars);
      drive.go(10.0, turned(radar, yaw));
      EXPECT_EQ(drive.of(radar).verdict, Verdict::kTurned) << radar << ' ' << yaw;
      EXPECT_NEAR(drive.of(radar).yaw_correction, -yaw, 0.5 * kDegree) << radar;
      drive.expectGood(radar);
    }
  }
  Drive drive;
  drive.go(10.0, turned(3, 3.0 * kDegree));
  EXPECT_EQ(drive.of(3).warning.rfind("rear_left: its mount is turned by +", 0), 0U) << drive.of(3).warning;
  EXPECT_NE(drive.of(3).warning.find("set mount_yaw_correction: -0.0"), std::string::npos)
      << drive.of(3).warning;
  drive.go(15.0);
  drive.expectGood();
}

TEST(RadarAgreement, NamesTheRadarThatIsReversed) {
  for (std::size_t radar = 0; radar < 5; ++radar) {
    Drive drive;
    drive.go(10.0, reversed(radar));
    EXPECT_EQ(drive.of(radar).verdict, Verdict::kReversed) << radar;
    EXPECT_NE(drive.of(radar).warning.find("doppler_scale: -1"), std::string::npos)
        << drive.of(radar).warning;
    drive.expectGood(radar);
  }
}

TEST(RadarAgreement, NamesAMountThatIsOffByAQuarterTurn) {
  Drive drive;
  drive.go(10.0, turned(1, 1.5));
  EXPECT_EQ(drive.of(1).verdict, Verdict::kTurned);
  EXPECT_NEAR(drive.of(1).yaw_correction, -1.5, 0.1);
  drive.expectGood(1);
}

TEST(RadarAgreement, TwoRadarsAreBothSuspect) {
  Drive drive({{"front"}, {"left"}}, {test::carMounts()[0], test::carMounts()[1]});
  drive.go(10.0);
  drive.expectGood();
  drive.go(10.0, reversed(1));
  for (const std::size_t radar : {0, 1}) {
    EXPECT_EQ(drive.of(radar).verdict, Verdict::kDisagrees);
    EXPECT_NE(drive.of(radar).warning.find("front"), std::string::npos) << drive.of(radar).warning;
    EXPECT_NE(drive.of(radar).warning.find("left"), std::string::npos);
  }
}

TEST(RadarAgreement, OneRadarShowsOnlyThatTheVehicleReverses) {
  Drive drive({{"front"}}, {test::carMounts()[0]});
  drive.go(10.0);
  drive.expectGood();
  EXPECT_TRUE(std::isinf(drive.of(0).yaw_std));
  drive.go(7.0, reversed(0));
  EXPECT_EQ(drive.agreement.warning(), "") << "a short manoeuvre";
  drive.go(3.0, reversed(0));
  EXPECT_EQ(drive.agreement.warning().rfind("drives backwards at 10 m/s", 0), 0U)
      << drive.agreement.warning();
  drive.go(1.0);
  drive.expectGood();
}

TEST(RadarAgreement, WhatIsConfiguredAnewIsForgotten) {
  Drive drive;
  drive.go(10.0, reversed(2));
  EXPECT_EQ(drive.of(2).verdict, Verdict::kReversed);
  drive.agreement.configure(drive.radars);
  EXPECT_EQ(drive.of(2).verdict, Verdict::kReversed) << "the same as before";
  drive.radars[2].doppler_scale = -1.0;
  drive.agreement.configure(drive.radars);
  drive.expectGood();
}

}  // namespace
}  // namespace radar_dot
