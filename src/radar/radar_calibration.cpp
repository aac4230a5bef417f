// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/radar_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "calibration_problem.h"

namespace radar_dot {
namespace {

using Quantity = CalibrationQuantity;

constexpr int kMaxIterations = 30;
constexpr double kConverged = 1e-3;  // of a limit of use
constexpr std::size_t kFewReturns = 200;
constexpr double kTurns = 0.02;  // rad/s, below which a drive is straight
constexpr double kBrakes = 0.2;  // m/s^2

/// Why a quantity is not known.
std::string reasonOf(Quantity quantity, bool is_delay, const CalibrationProblem& problem, std::size_t radars,
                     std::size_t returns) {
  const Eigen::Array3d excitation = problem.excitation();
  if (returns < kFewReturns) return fmt::format("only {} returns of it are static", returns);
  const bool position = quantity == Quantity::kX || quantity == Quantity::kY;
  if ((position || is_delay) && excitation[0] < kTurns)
    return fmt::format("the vehicle hardly turns ({:.3f} rad/s)", excitation[0]);
  if (quantity == Quantity::kTimeOffset && excitation[0] < kTurns && excitation[1] < kBrakes) {
    return fmt::format("the motion hardly changes ({:.2f} m/s^2, {:.3f} rad/s)", excitation[1],
                       excitation[0]);
  }
  if (!problem.references(2) && (quantity == Quantity::kYaw || position || is_delay)) {
    return radars == 1 ? "one radar alone does not tell it from a curve without a reference"
                       : "without a reference of the yaw rate it is not told from a curve";
  }
  if (!problem.references(0) && (quantity == Quantity::kDopplerScale || position))
    return radars == 1 ? "one radar alone does not tell it without a reference of the speed"
                       : "there is no reference of the speed";
  return "the drive is too short, or its returns err too much";
}

CalibratedValue valueOf(double found, double std, Quantity quantity, bool is_delay, bool asked,
                        const CalibrationProblem& problem, std::size_t radars, std::size_t returns,
                        double limit) {
  CalibratedValue value{found, std, ""};
  if (!asked) {
    value.std = std::numeric_limits<double>::infinity();
    value.reason = "it was not asked for";
  } else if (!(std < limit)) {
    value.reason = reasonOf(quantity, is_delay, problem, radars, returns);
  }
  return value;
}

void chooseFree(const CalibrationParams& params, std::size_t radars, CalibrationProblem& problem) {
  const auto set = [&problem](Eigen::Index i, bool is) { problem.free[static_cast<std::size_t>(i)] = is; };
  for (std::size_t radar = 0; radar < radars; ++radar) {
    set(problem.at(radar, Quantity::kX), params.positions);
    set(problem.at(radar, Quantity::kY), params.positions);
    set(problem.at(radar, Quantity::kDopplerScale), params.scales);
    set(problem.at(radar, Quantity::kTimeOffset), params.time_offsets);
  }
  set(problem.delay(), params.common_delay);
  set(problem.bias(), params.rate_has_bias);
}

RadarCalibration radarOf(const std::vector<CalibratedRadar>& radars, std::size_t radar,
                         const CalibrationProblem& problem, const Eigen::VectorXd& std, std::size_t returns) {
  RadarCalibration found;
  found.name = radars[radar].name;
  found.used = returns;
  const auto [forward, reversed] = problem.votes()[radar];
  found.doppler_sign = reversed > forward ? -1 : 1;
  if (forward + reversed > 0)
    found.sign_share =
        static_cast<double>(std::max(forward, reversed)) / static_cast<double>(forward + reversed);
  for (std::size_t i = 0; i < kCalibrationQuantities; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    const Eigen::Index at = problem.at(radar, quantity);
    double value = problem.quantities[at];
    if (quantity == Quantity::kDopplerScale) value *= found.doppler_sign;
    found.values[i] = valueOf(value, std[at], quantity, false, problem.free[static_cast<std::size_t>(at)],
                              problem, radars.size(), returns, problem.limit(at, problem.delay()));
  }
  return found;
}

void requireData(const std::vector<CalibratedRadar>& radars, const std::vector<CalibrationDrive>& drives) {
  std::size_t returns = 0;
  for (const CalibrationDrive& drive : drives)
    for (const CalibrationScan& scan : drive.scans) {
      if (scan.radar >= radars.size()) throw std::invalid_argument("a scan is of no radar of the list");
      returns += scan.returns.size();
    }
  if (returns == 0) throw std::invalid_argument("no radar has returns to calibrate with");
}

}  // namespace

void CalibrationParams::describe(FieldList& fields) {
  fields.group("Calibration");
  fields.add("positions", positions, "Find x and y of the mounts, too");
  fields.add("scales", scales, "Find the scale of the range rates, too");
  fields.add("time_offsets", time_offsets, "Find the offsets of the stamps, too");
  fields.add("common_delay", common_delay, "Find the delay of the bearings, which all radars share, too");
  fields.add("slip_std", slip_std,
             "1 sigma of the slip angle at the origin of base_frame, where no reference tells vy", "rad",
             {1e-4, 1.0});
  fields.add("knot_interval", knot_interval, "Between the knots of the motion over time", "s", {0.05, 2.0});
}

Calibration calibrateRadars(const std::vector<CalibratedRadar>& radars,
                            const std::vector<CalibrationDrive>& drives, const CalibrationParams& params,
                            const std::function<void()>& check) {
  requireData(radars, drives);
  CalibrationProblem problem(radars, drives, params, true);
  chooseFree(params, radars.size(), problem);
  check();
  problem.start();
  Calibration calibration;
  double moved = 1.0;
  while (moved > kConverged && calibration.iterations < kMaxIterations) {
    check();
    moved = problem.step();
    ++calibration.iterations;
  }
  const Eigen::VectorXd std = problem.covariance().diagonal().cwiseMax(0.0).cwiseSqrt();
  const auto residuals = problem.residuals();
  std::size_t returns = 0;
  for (std::size_t radar = 0; radar < radars.size(); ++radar) {
    calibration.radars.push_back(radarOf(radars, radar, problem, std, residuals[radar].second));
    RadarCalibration& found = calibration.radars.back();
    for (const CalibrationDrive& drive : drives)
      for (const CalibrationScan& scan : drive.scans) found.scans += scan.radar == radar ? 1 : 0;
    returns += found.used;
  }
  const Eigen::Index delay = problem.delay();
  calibration.bearing_delay =
      valueOf(problem.quantities[delay] - params.bearing_delay, std[delay], Quantity::kYaw, true,
              params.common_delay, problem, radars.size(), returns, problem.limit(delay, delay));
  calibration.gyro_bias = problem.quantities[problem.bias()];
  const Eigen::Array3d excitation = problem.excitation();
  calibration.turning = excitation[0];
  calibration.braking = excitation[1];
  calibration.yaw_acceleration = excitation[2];
  return calibration;
}

CalibrationResiduals calibrationResiduals(const std::vector<CalibratedRadar>& radars,
                                          const std::vector<CalibrationDrive>& drives,
                                          const CalibrationParams& params, const Calibration& calibration) {
  requireData(radars, drives);
  CalibrationProblem problem(radars, drives, params, false);
  problem.free.assign(problem.free.size(), false);
  for (std::size_t radar = 0; radar < calibration.radars.size(); ++radar) {
    const RadarCalibration& found = calibration.radars[radar];
    for (std::size_t i = 0; i < kCalibrationQuantities; ++i) {
      if (!found.values[i].observable()) continue;
      const auto quantity = static_cast<Quantity>(i);
      problem.quantities[problem.at(radar, quantity)] = quantity == Quantity::kDopplerScale
                                                            ? found.doppler_sign * found.values[i].value
                                                            : found.values[i].value;
    }
  }
  if (!calibration.radars.empty() && calibration.bearing_delay.observable())
    problem.quantities[problem.delay()] += calibration.bearing_delay.value;
  problem.start();
  for (int i = 0; i < 6; ++i) problem.step();
  CalibrationResiduals result;
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [squares, returns] : problem.residuals()) {
    result.by_radar.push_back(std::sqrt(squares / static_cast<double>(returns)));
    sum += squares;
    count += returns;
  }
  result.all = std::sqrt(sum / static_cast<double>(count));
  result.motion = problem.differences();
  return result;
}

void splitDrives(const std::vector<CalibrationDrive>& drives, double length,
                 std::vector<CalibrationDrive>& fitted, std::vector<CalibrationDrive>& held_out) {
  for (const CalibrationDrive& drive : drives) {
    double begin = std::numeric_limits<double>::infinity();
    for (const CalibrationScan& scan : drive.scans) begin = std::min(begin, scan.time);
    std::map<std::int64_t, CalibrationDrive> pieces;
    const auto piece = [&](double time) -> CalibrationDrive& {
      return pieces[static_cast<std::int64_t>(std::floor((time - begin) / length))];
    };
    for (const CalibrationScan& scan : drive.scans) piece(scan.time).scans.push_back(scan);
    for (const ReferenceReading& reading : drive.reference) piece(reading.time).reference.push_back(reading);
    for (auto& [number, part] : pieces) {
      if (!part.scans.empty()) (number % 2 == 0 ? fitted : held_out).push_back(std::move(part));
    }
  }
}

}  // namespace radar_dot
