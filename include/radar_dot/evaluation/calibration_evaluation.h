// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/figures.h"
#include "radar_dot/radar/radar_calibration.h"
#include "radar_dot/radar/sweep_estimator.h"

namespace radar_dot::evaluation {

/// What tells the motion beside the radars.
enum class CalibrationReference { kPoses, kWheels, kNone };

}  // namespace radar_dot::evaluation

namespace radar_dot {
template <>
struct EnumNames<evaluation::CalibrationReference> {
  static constexpr EnumName<evaluation::CalibrationReference> kValues[] = {
      {evaluation::CalibrationReference::kPoses, "poses", "the poses of the dataset"},
      {evaluation::CalibrationReference::kWheels, "wheels", "the speed of the rear wheels, of the CAN bus"},
      {evaluation::CalibrationReference::kNone, "none", "nothing: the rear axle does not slip"}};
};
}  // namespace radar_dot

namespace radar_dot::evaluation {

/// Drives of one vehicle, ready for calibrateRadars().
struct CalibrationData {
  std::vector<CalibratedRadar> radars;   ///< with the mounts and corrections of the configuration
  std::vector<RadarEntry> entries;       ///< of the same radars, as configured
  std::vector<std::string> entry_names;  ///< of the same entries
  std::vector<std::string> frames;       ///< of the same radars
  std::vector<CalibrationDrive> drives;
  bool rate_has_bias = false;  ///< of CalibrationParams
};

/// All scenes of the tables.
/// @throws dataset::DatasetError for unreadable input, and where the mounts of two scenes differ: each
///         vehicle has a calibration of its own
CalibrationData calibrationData(const dataset::Tables& tables, const EgoVelocityConfig& config,
                                CalibrationReference reference);

/// A calibration, and what it is worth.
struct CalibrationReport {
  Calibration calibration;  ///< of all drives
  double block = 0.0;       ///< s; every other one was held out; 0: each drive in turn
  CalibrationResiduals before,
      after;         ///< of what was held out: as configured, and with the calibration of the rest
  std::string yaml;  ///< lines for the section ego_velocity
  std::map<std::string, MountYaw> mount_yaws;       ///< those that were found, for mount_yaws_file
  std::map<std::string, Eigen::Isometry3d> mounts;  ///< T_base_from_sensor as found, by frame

  /// False where what was held out agrees less than before, on the mean over residuals and motion.
  bool isWorthIt() const;
  void describe(Figures& figures);
};

/// Quantities beside the yaws are kept only where what was held out agrees better with them than with the
/// yaws alone: scales and times that differ from drive to drive are no properties of the mounts.
/// @param block  s, of the stretches that are held out where there is one drive only
CalibrationReport calibrate(const CalibrationData& data, const EgoVelocityConfig& config,
                            const CalibrationParams& params, double block);

/// For people, with the reasons of what is not observable, and the lines to paste.
std::string formatTable(const CalibrationReport& report);

}  // namespace radar_dot::evaluation
