// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/common/radar_noise.h"
#include "radar_dot/radar/doppler_returns.h"

namespace radar_dot {

/// What is calibrated of each radar.
enum class CalibrationQuantity { kYaw, kX, kY, kDopplerScale, kTimeOffset };
template <>
struct EnumNames<CalibrationQuantity> {
  static constexpr EnumName<CalibrationQuantity> kValues[] = {
      {CalibrationQuantity::kYaw, "yaw", "rad, added to the yaw of the mount"},
      {CalibrationQuantity::kX, "x", "m, added to the position of the mount in the base frame"},
      {CalibrationQuantity::kY, "y", "m, the same"},
      {CalibrationQuantity::kDopplerScale, "doppler_scale", "factor on the range rates"},
      {CalibrationQuantity::kTimeOffset, "time_offset", "s, added to the stamps"}};
};
inline constexpr std::size_t kCalibrationQuantities = 5;

/// A radar as it is configured; what is found is relative to that.
struct CalibratedRadar {
  std::string name;
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
};

struct CalibrationScan {
  std::size_t radar = 0;
  double time = 0.0;  ///< s
  std::vector<DopplerReturn> returns;
};

/// The motion of the base frame by another source: vx, vy (m/s) and yaw rate (rad/s); NaN: not measured.
struct ReferenceReading {
  double time = 0.0;  ///< s
  Eigen::Array3d velocity = Eigen::Array3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// A stretch of driving without gaps; scans and readings in any order.
struct CalibrationDrive {
  std::vector<CalibrationScan> scans;
  std::vector<ReferenceReading> reference;
};

/// Parameters of calibrateRadars.
struct CalibrationParams {
  RadarNoise noise;
  double bearing_delay = 0.0;  ///< s, as configured
  double knot_interval = 0.2;
  double slip_std = 0.01;
  bool rate_has_bias = false;  ///< the yaw rate of the reference is that of a gyroscope
  bool positions = true, scales = true, time_offsets = true, common_delay = true;

  void describe(FieldList& fields);
};

/// One quantity as found.
struct CalibratedValue {
  double value = 0.0;  ///< correction; of a scale the factor
  double std = 0.0;  ///< 1 sigma; where it is not observable, what it would be, and infinite where not asked
  std::string reason;  ///< why it is not observable; empty: it is
  bool observable() const { return reason.empty(); }
};

struct RadarCalibration {
  std::string name;
  int doppler_sign = 1;             ///< -1: range rates have the other sign
  double sign_share = 0.0;          ///< of the scans that tell, those that say so; 0: none told
  std::size_t scans = 0, used = 0;  ///< `used`: returns that are static
  std::array<CalibratedValue, kCalibrationQuantities> values;
  const CalibratedValue& operator[](CalibrationQuantity quantity) const {
    return values[static_cast<std::size_t>(quantity)];
  }
};

struct Calibration {
  std::vector<RadarCalibration> radars;
  CalibratedValue bearing_delay;                 ///< s, added to the one configured; of all radars
  double gyro_bias = 0.0;                        ///< rad/s, of the reference
  double turning = 0.0;                          ///< rad/s, root mean square
  double braking = 0.0, yaw_acceleration = 0.0;  ///< m/s^2, rad/s^2, the same
  int iterations = 0;
};

/// How well radars agree with a calibration, and their motion with the reference, which takes no part.
struct CalibrationResiduals {
  std::vector<double> by_radar;  ///< m/s, root mean square of the static returns
  double all = 0.0;              ///< m/s
  /// Mean absolute difference from the reference of vx, vy, yaw rate; NaN where it has none.
  Eigen::Array3d motion = Eigen::Array3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// Calibrates the radars of a vehicle from what they see while it drives.
///
/// A static return in the direction u (base frame) with the range rate d obeys
///     0 = d + Rz(psi + D w) u . (v + w x (p + q)) / s,    v, w at the time t + T
/// with scale s, yaw psi, displacement q and time offset T of its radar, and the bearing delay D that they
/// have in common. The motion v, w is a cubic B-spline over the drive. All are found together by
/// reweighted least squares with Cauchy weights; the motion is eliminated from the normal equations. Without
/// a lateral velocity in the reference, vy = 0 within slip_std, for a base frame at the rear axle.
///
/// The covariance is that of the sums over seconds of each radar's residuals (sandwich estimator; White,
/// Maximum likelihood estimation of misspecified models, 1982), as the returns of a scan, and those of one
/// object, err together. Quantities whose 1 sigma is above a limit of use are held where they are, the worst
/// first, and named as not observable.
/// @param check  called before each iteration; may throw to end the work
/// @throws std::invalid_argument where there is nothing to calibrate with
Calibration calibrateRadars(
    const std::vector<CalibratedRadar>& radars, const std::vector<CalibrationDrive>& drives,
    const CalibrationParams& params, const std::function<void()>& check = [] {});

/// Residuals of drives that were not used.
/// @param calibration  without radars: as configured
CalibrationResiduals calibrationResiduals(const std::vector<CalibratedRadar>& radars,
                                          const std::vector<CalibrationDrive>& drives,
                                          const CalibrationParams& params, const Calibration& calibration);

/// Cut into pieces of `length` s, every other one into `fitted`, the others into `held_out`.
void splitDrives(const std::vector<CalibrationDrive>& drives, double length,
                 std::vector<CalibrationDrive>& fitted, std::vector<CalibrationDrive>& held_out);

}  // namespace radar_dot
