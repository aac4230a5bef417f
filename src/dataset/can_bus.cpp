// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/can_bus.h"

#include <fmt/format.h>

#include <algorithm>

#include "json_records.h"
#include "json_table_writer.h"

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

/// Writes can_bus/<scene>_<part>.json; nothing where there are no rows.
template <typename Row, typename Write>
void writePart(const std::filesystem::path& dataroot, std::string_view scene, std::string_view part,
               const std::vector<Row>& rows, const Write& write) {
  if (rows.empty()) return;
  JsonTableWriter file(dataroot / fmt::format("can_bus/{}_{}.json", scene, part));
  for (const Row& row : rows) {
    file.record().set("utime", row.timestamp_us);
    write(file, row);
  }
  file.finish();
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

void writeCanBus(const std::filesystem::path& dataroot, std::string_view scene, const CanBus& can_bus) {
  writePart(dataroot, scene, "pose", can_bus.poses, [](JsonTableWriter& record, const CanPose& row) {
    record.set("accel", row.acceleration)
        .set("orientation", row.orientation)
        .set("pos", row.position)
        .set("rotation_rate", row.rotation_rate)
        .set("vel", row.velocity);
  });
  writePart(dataroot, scene, "ms_imu", can_bus.imu, [](JsonTableWriter& record, const CanImu& row) {
    record.set("linear_accel", row.linear_acceleration)
        .set("q", row.orientation)
        .set("rotation_rate", row.rotation_rate);
  });
  writePart(dataroot, scene, "zoe_veh_info", can_bus.vehicle,
            [](JsonTableWriter& record, const CanVehicleInfo& row) {
              record.set("FL_wheel_speed", row.front_left_rpm)
                  .set("FR_wheel_speed", row.front_right_rpm)
                  .set("RL_wheel_speed", row.rear_left_rpm)
                  .set("RR_wheel_speed", row.rear_right_rpm)
                  .set("odom_speed", row.odometer_speed_kph)
                  .set("steer_corrected", row.steering_angle_deg);
            });
}

}  // namespace radar_dot::dataset
