// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/radar_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>

namespace radar_dot {
namespace {

using Quantity = CalibrationQuantity;

/// How a radar truly is, against how it is said to be.
struct Truth {
  double x, y, yaw;  // m, rad, said
  double turned = 0.0, dx = 0.0, dy = 0.0, scale = 1.0, offset = 0.0;
  double sign = 1.0;
};

using Motion = std::function<Eigen::Vector3d(double)>;  // vx, vy, yaw rate at a time

Eigen::Vector3d winding(double t) { return {10.0 + 3.0 * std::sin(0.7 * t), 0.0, 0.3 * std::sin(0.5 * t)}; }
Eigen::Vector3d straight(double) { return {12.0, 0.0, 0.0}; }

std::vector<Truth> fiveRadars() {
  return {{3.4, 0.0, 0.0, 0.030, 0.0, 0.0, 0.98, 0.030},
          {2.4, 0.8, 1.57, -0.020, 0.0, 0.0, 1.02, -0.050},
          {2.4, -0.8, -1.57, 0.010, 0.0, 0.0, 1.0, 0.050},
          {-0.6, 0.6, 3.05, -0.015, 0.0, 0.0, 1.01, 0.0},
          {-0.6, -0.6, -3.05, 0.005, 0.0, 0.0, 0.99, -0.020}};
}

std::vector<CalibratedRadar> saidOf(const std::vector<Truth>& truths) {
  std::vector<CalibratedRadar> radars;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    CalibratedRadar radar;
    radar.name = "radar" + std::to_string(i);
    radar.T_base_from_sensor = Eigen::Translation3d(truths[i].x, truths[i].y, 0.5) *
                               Eigen::AngleAxisd(truths[i].yaw, Eigen::Vector3d::UnitZ());
    radars.push_back(radar);
  }
  return radars;
}

struct Simulation {
  Motion motion = winding;
  double duration = 20.0, delay = 0.0;
  bool reference = true;
  unsigned seed = 1;
};

CalibrationDrive drive(const std::vector<Truth>& truths, const Simulation& simulation) {
  CalibrationDrive drive;
  std::mt19937 random(simulation.seed);
  std::normal_distribution<double> noise;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t r = 0; r < truths.size(); ++r) {
    const Truth& truth = truths[r];
    for (double stamp = 0.01 * static_cast<double>(r); stamp < simulation.duration; stamp += 0.077) {
      const Eigen::Vector3d m = simulation.motion(stamp + truth.offset);
      const Eigen::Vector2d velocity(m.x() - m.z() * (truth.y + truth.dy),
                                     m.y() + m.z() * (truth.x + truth.dx));
      CalibrationScan scan;
      scan.radar = r;
      scan.time = stamp;
      for (int i = 0; i < 25; ++i) {
        const double in_sensor = 1.0 * uniform(random);
        const double angle = in_sensor + truth.yaw + truth.turned;
        double rate = -(std::cos(angle) * velocity.x() + std::sin(angle) * velocity.y());
        if (i < 3) rate += 8.0 * uniform(random);  // moves
        const double seen = in_sensor - simulation.delay * m.z() + 0.004 * noise(random);
        DopplerReturn measured;
        measured.bearing = Eigen::Vector3d(std::cos(seen), std::sin(seen), 0.0).cast<float>();
        measured.range = 20.F;
        measured.doppler = static_cast<float>(truth.sign * rate / truth.scale + 0.06 * noise(random));
        scan.returns.push_back(measured);
      }
      drive.scans.push_back(scan);
    }
  }
  for (double time = 0.0; simulation.reference && time < simulation.duration; time += 0.05) {
    ReferenceReading reading;
    reading.time = time;
    reading.velocity = simulation.motion(time).array() +
                       Eigen::Array3d(0.02 * noise(random), 0.02 * noise(random), 0.004 * noise(random));
    drive.reference.push_back(reading);
  }
  return drive;
}

double errorOf(const RadarCalibration& found, Quantity quantity, const Truth& truth) {
  const double truths[] = {truth.turned, truth.dx, truth.dy, truth.scale, truth.offset};
  return found[quantity].value - truths[static_cast<std::size_t>(quantity)];
}

TEST(RadarCalibration, FindsMountsScalesAndClocks) {
  const std::vector<Truth> truths = fiveRadars();
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, {})}, {});
  for (std::size_t r = 0; r < truths.size(); ++r) {
    SCOPED_TRACE(found.radars[r].name);
    for (const auto& [quantity, limit] :
         {std::pair(Quantity::kYaw, 0.002), std::pair(Quantity::kTimeOffset, 0.005),
          std::pair(Quantity::kDopplerScale, 0.003)}) {
      const CalibratedValue& value = found.radars[r][quantity];
      SCOPED_TRACE(toString(quantity));
      EXPECT_TRUE(value.observable()) << value.reason;
      const double error = errorOf(found.radars[r], quantity, truths[r]);
      EXPECT_LT(std::abs(error), limit);
      EXPECT_LT(std::abs(error), 3.0 * value.std);
      EXPECT_LT(value.std, limit);
    }
    EXPECT_EQ(found.radars[r].doppler_sign, 1);
  }
}

TEST(RadarCalibration, FindsPositionsAndTheDelayOfBearings) {
  std::vector<Truth> truths = fiveRadars();
  truths[0].dx = 0.10;
  truths[3].dy = -0.08;
  Simulation simulation;
  simulation.delay = 0.04;
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, simulation)}, {});
  for (std::size_t r = 0; r < truths.size(); ++r) {
    for (const Quantity quantity : {Quantity::kX, Quantity::kY}) {
      const CalibratedValue& value = found.radars[r][quantity];
      EXPECT_TRUE(value.observable()) << value.reason;
      EXPECT_LT(std::abs(errorOf(found.radars[r], quantity, truths[r])), 3.0 * value.std) << r;
      EXPECT_LT(value.std, 0.03);
    }
  }
  EXPECT_TRUE(found.bearing_delay.observable());
  EXPECT_NEAR(found.bearing_delay.value, 0.04, 0.005);
}

TEST(RadarCalibration, SigmasCoverTheErrors) {
  const std::vector<Truth> truths = fiveRadars();
  std::array<double, kCalibrationQuantities> sums{};
  double count = 0.0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Simulation simulation;
    simulation.seed = seed;
    simulation.duration = 15.0;
    const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, simulation)}, {});
    for (std::size_t r = 0; r < truths.size(); ++r) {
      for (std::size_t q = 0; q < kCalibrationQuantities; ++q) {
        const auto quantity = static_cast<Quantity>(q);
        sums[q] += std::pow(errorOf(found.radars[r], quantity, truths[r]) / found.radars[r][quantity].std, 2);
      }
    }
    count += static_cast<double>(truths.size());
  }
  // 30 squares of normal errors, not all independent: their mean lies within 0.4 and 2 but once in a
  // thousand.
  for (std::size_t q = 0; q < kCalibrationQuantities; ++q) {
    EXPECT_LT(sums[q] / count, 2.0) << toString(static_cast<Quantity>(q));
    EXPECT_GT(sums[q] / count, 0.3) << toString(static_cast<Quantity>(q));
  }
}

TEST(RadarCalibration, AStraightDriveSaysWhatItCannotSee) {
  const std::vector<Truth> truths = fiveRadars();
  Simulation simulation;
  simulation.motion = straight;
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, simulation)}, {});
  for (std::size_t r = 0; r < truths.size(); ++r) {
    const RadarCalibration& radar = found.radars[r];
    EXPECT_TRUE(radar[Quantity::kYaw].observable());
    EXPECT_LT(std::abs(errorOf(radar, Quantity::kYaw, truths[r])), 0.002);
    EXPECT_NE(radar[Quantity::kX].reason.find("hardly turns"), std::string::npos);
    EXPECT_NE(radar[Quantity::kY].reason.find("hardly turns"), std::string::npos);
    EXPECT_NE(radar[Quantity::kTimeOffset].reason.find("motion hardly changes"), std::string::npos);
  }
  EXPECT_NE(found.bearing_delay.reason.find("hardly turns"), std::string::npos);
}

TEST(RadarCalibration, FindsAReversedSign) {
  std::vector<Truth> truths = fiveRadars();
  truths[1].sign = truths[3].sign = -1.0;
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, {})}, {});
  for (std::size_t r = 0; r < truths.size(); ++r) {
    EXPECT_EQ(found.radars[r].doppler_sign, truths[r].sign > 0.0 ? 1 : -1);
    EXPECT_GT(found.radars[r].sign_share, 0.9);
    EXPECT_LT(std::abs(errorOf(found.radars[r], Quantity::kYaw, truths[r])), 0.002);
    EXPECT_LT(std::abs(errorOf(found.radars[r], Quantity::kDopplerScale, truths[r])), 0.003);
  }
}

TEST(RadarCalibration, WithoutAReferenceTellsWhatTheRadarsTellOfEachOther) {
  const std::vector<Truth> truths = fiveRadars();
  Simulation simulation;
  simulation.reference = false;
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, simulation)}, {});
  // Time offsets against their mean.
  double mean = 0.0;
  for (const Truth& truth : truths) mean += truth.offset / static_cast<double>(truths.size());
  for (std::size_t r = 0; r < truths.size(); ++r) {
    for (std::size_t q = 0; q < kCalibrationQuantities; ++q) {
      const auto quantity = static_cast<Quantity>(q);
      const CalibratedValue& value = found.radars[r].values[q];
      double error = errorOf(found.radars[r], quantity, truths[r]);
      if (quantity == Quantity::kTimeOffset) error += mean;
      if (!value.observable()) continue;
      EXPECT_LT(std::abs(error), 4.0 * value.std) << r << toString(quantity);
    }
  }
  EXPECT_FALSE(found.radars[0][Quantity::kYaw].observable());
  EXPECT_NE(found.radars[0][Quantity::kYaw].reason.find("curve"), std::string::npos);
}

TEST(RadarCalibration, OneRadarAloneSaysThatItNeedsAReference) {
  const std::vector<Truth> truths = {fiveRadars().front()};
  Simulation simulation;
  simulation.reference = false;
  const Calibration found = calibrateRadars(saidOf(truths), {drive(truths, simulation)}, {});
  EXPECT_NE(found.radars[0][Quantity::kYaw].reason.find("one radar alone"), std::string::npos);
}

TEST(RadarCalibration, HeldOutResidualsFall) {
  const std::vector<Truth> truths = fiveRadars();
  std::vector<CalibrationDrive> fitted, held_out;
  splitDrives({drive(truths, {})}, 5.0, fitted, held_out);
  ASSERT_EQ(fitted.size(), 2U);
  ASSERT_EQ(held_out.size(), 2U);
  const std::vector<CalibratedRadar> radars = saidOf(truths);
  const Calibration found = calibrateRadars(radars, fitted, {});
  const CalibrationResiduals before = calibrationResiduals(radars, held_out, {}, {});
  const CalibrationResiduals after = calibrationResiduals(radars, held_out, {}, found);
  EXPECT_LT(after.all, 0.7 * before.all);
  // The reference's own noise, 1 sigma 0.004 rad/s, has a mean absolute value of 0.0032 rad/s.
  EXPECT_LT(after.motion[2], 0.005);
  EXPECT_GT(before.motion[2], 0.015);
}

TEST(RadarCalibration, RefusesNothing) {
  EXPECT_THROW(calibrateRadars(saidOf(fiveRadars()), {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot
