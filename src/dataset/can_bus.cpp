// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/can_bus.h"

#include <fmt/format.h>

#include <algorithm>

#include "json_records.h"

namespace radar_dot::dataset {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Reads can_bus/<scene>_<part>.json in the order of time; nothing where it does not exist.
template <typename Row, typename Read>
std::vector<Row> readPart(const std::filesystem::path& dataroot, std::string_view scene,
                          std::string_view part, const Record::FieldNames& fields, const Read& read) {
  const std::string label = fmt::format("can_bus/{}_{}.json", scene, part);
  std::vector<Row> rows;
  if (!std::filesystem::exists(dataroot / label)) return rows;
  readRecords(dataroot / label, label, fields, [&](const Record& record) {
    Row& row = rows.emplace_back();
    row.timestamp_us = record.integer(0);
    read(record, row);
  });
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.timestamp_us < b.timestamp_us; });
  return rows;
}

}  // namespace

double rearAxleSpeed(const CanVehicleInfo& info) noexcept {
  const double mean_rpm = 0.5 * (info.rear_left_rpm + info.rear_right_rpm);
  return mean_rpm * 2.0 * kPi * kZoeWheelRadius / 60.0;
}

CanBus readCanBus(const std::filesystem::path& dataroot, std::string_view scene) {
  CanBus can_bus;
  can_bus.poses = readPart<CanPose>(dataroot, scene, "pose",
                                    {"utime", "pos", "orientation", "vel", "accel", "rotation_rate"},
                                    [](const Record& record, CanPose& row) {
                                      row.position = record.numbers<3>(1);
                                      row.orientation = record.quaternion(2);
                                      row.velocity = record.numbers<3>(3);
                                      row.acceleration = record.numbers<3>(4);
                                      row.rotation_rate = record.numbers<3>(5);
                                    });
  can_bus.imu = readPart<CanImu>(dataroot, scene, "ms_imu", {"utime", "linear_accel", "q", "rotation_rate"},
                                 [](const Record& record, CanImu& row) {
                                   row.linear_acceleration = record.numbers<3>(1);
                                   row.orientation = record.quaternion(2);
                                   row.rotation_rate = record.numbers<3>(3);
                                 });
  can_bus.vehicle = readPart<CanVehicleInfo>(dataroot, scene, "zoe_veh_info",
                                             {"utime", "FL_wheel_speed", "FR_wheel_speed", "RL_wheel_speed",
                                              "RR_wheel_speed", "odom_speed", "steer_corrected"},
                                             [](const Record& record, CanVehicleInfo& row) {
                                               row.front_left_rpm = record.number(1);
                                               row.front_right_rpm = record.number(2);
                                               row.rear_left_rpm = record.number(3);
                                               row.rear_right_rpm = record.number(4);
                                               row.odometer_speed_kph = record.number(5);
                                               row.steering_angle_deg = record.number(6);
                                             });
  return can_bus;
}

}  // namespace radar_dot::dataset
