// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "radar_dot/simulation/drive_simulator.h"

namespace radar_dot::simulation {

enum class SensorKind { kCamera, kRadar, kLidar };

/// A sensor that takes part in a drive.
struct DriveSensor {
  SensorKind kind = SensorKind::kCamera;
  SensorMount mount;
  std::size_t number = 0;  ///< in cameraMounts() or radarMounts()
  double rate = 0.0;       ///< Hz
  double offset_s = 0.0;   ///< of its keyframes behind those of the dataset
};

/// A reading to be taken.
struct PlannedReading {
  std::size_t sensor = 0;  ///< number in DrivePlan::sensors
  std::int64_t timestamp_us = 0;
  double time_s = 0.0;  ///< the same, since the first keyframe
  std::size_t sample = 0;
  bool is_key_frame = false;
  std::int64_t next_us = -1;  ///< of the sensor's next reading, -1 = none
};

/// When each sensor reads during a drive.
struct DrivePlan {
  std::int64_t start_us = 0;
  std::vector<DriveSensor> sensors;
  std::vector<std::int64_t> samples_us;
  std::vector<PlannedReading> readings;  ///< sensor by sensor, in time order
};

DrivePlan planDrive(const DriveOptions& options, std::size_t number);

}  // namespace radar_dot::simulation
