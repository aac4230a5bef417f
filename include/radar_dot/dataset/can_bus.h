// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "radar_dot/dataset/left_out.h"

namespace radar_dot::dataset {

/// can_bus/<scene>_pose.json, 50 Hz.
struct CanPose {
  std::int64_t timestamp_us = 0;
  std::array<double, 3> position{};       ///< m, map frame
  std::array<double, 4> orientation{};    ///< w x y z, map from base
  std::array<double, 3> velocity{};       ///< m/s, base frame
  std::array<double, 3> acceleration{};   ///< m/s^2, base frame
  std::array<double, 3> rotation_rate{};  ///< rad/s, base frame
};

/// can_bus/<scene>_ms_imu.json, 100 Hz.
struct CanImu {
  std::int64_t timestamp_us = 0;
  std::array<double, 3> linear_acceleration{};  ///< m/s^2, IMU frame, with gravity
  std::array<double, 4> orientation{};          ///< w x y z
  std::array<double, 3> rotation_rate{};        ///< rad/s, IMU frame
};

/// can_bus/<scene>_zoe_veh_info.json, 100 Hz. Wheel speeds are revolutions per minute.
struct CanVehicleInfo {
  std::int64_t timestamp_us = 0;
  double front_left_rpm = 0.0;
  double front_right_rpm = 0.0;
  double rear_left_rpm = 0.0;
  double rear_right_rpm = 0.0;
  double odometer_speed_kph = 0.0;
  double steering_angle_deg = 0.0;  ///< steering wheel, corrected
};

/// Loaded radius of the nuScenes car's wheels, m.
inline constexpr double kZoeWheelRadius = 0.305;

/// Speed of the rear axle (the base frame's origin), m/s, from the two rear wheels.
double rearAxleSpeed(const CanVehicleInfo& info) noexcept;

/// What the CAN bus extension holds of a scene; a part whose file does not exist is empty.
struct CanBus {
  std::vector<CanPose> poses;
  std::vector<CanImu> imu;
  std::vector<CanVehicleInfo> vehicle;
  bool empty() const noexcept { return poses.empty() && imu.empty() && vehicle.empty(); }
};

/// Reads dataroot/can_bus/<scene>_*.json, sorted by time. Rows with a value that is null, not finite or no
/// unit quaternion, and those with the time of another row, are left out.
/// @throws DatasetError naming file, record and field.
CanBus readCanBus(const std::filesystem::path& dataroot, std::string_view scene,
                  const LeftOut& left_out = {});
/// CanBus::vehicle alone.
std::vector<CanVehicleInfo> readVehicleInfo(const std::filesystem::path& dataroot, std::string_view scene,
                                            const LeftOut& left_out = {});

/// Writes dataroot/can_bus/<scene>_*.json, the inverse of readCanBus; the folder must exist. A part without
/// messages gets no file.
/// @throws DatasetError naming a file that cannot be written.
void writeCanBus(const std::filesystem::path& dataroot, std::string_view scene, const CanBus& can_bus);

}  // namespace radar_dot::dataset
