// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/can_bus.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "can_fields.h"
#include "json_records.h"
#include "json_table_writer.h"

namespace radar_dot::dataset {
namespace {

constexpr double kPi = 3.14159265358979323846;

void readValue(const Record& record, std::size_t field, double& value) { value = record.number(field); }
void readValue(const Record& record, std::size_t field, std::array<double, 3>& value) {
  value = record.numbers<3>(field);
}
void readValue(const Record& record, std::size_t field, std::array<double, 4>& value) {
  value = record.quaternion(field);
}

/// Reads can_bus/<scene>_<part>.json in the order of time; nothing where it does not exist. Rows without a
/// value, or with the time of another row, are left out.
template <typename Row>
std::vector<Row> readPart(const std::filesystem::path& dataroot, std::string_view scene,
                          std::string_view part, const LeftOut& left_out) {
  const std::string label = fmt::format("can_bus/{}_{}.json", scene, part);
  std::vector<Row> rows;
  if (!std::filesystem::exists(dataroot / label)) return rows;
  Record::FieldNames names = {"utime"};
  forEachCanField(Row(), [&](std::string_view name, const auto&) { names.push_back(name); });
  std::size_t listed = 0;
  std::string reason;
  readRecords(dataroot / label, label, names, [&](const Record& record) {
    ++listed;
    try {
      Row row;
      row.timestamp_us = record.integer(0);
      std::size_t field = 0;
      forEachCanField(row, [&](std::string_view, auto& value) { readValue(record, ++field, value); });
      rows.push_back(row);
    } catch (const ValueError& error) {
      if (reason.empty()) reason = error.what();
    }
  });
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.timestamp_us < b.timestamp_us; });
  const auto repeated = std::unique(
      rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.timestamp_us == b.timestamp_us; });
  if (repeated != rows.end() && reason.empty())
    reason = fmt::format("two have the time {}", std::prev(repeated)->timestamp_us);
  rows.erase(repeated, rows.end());
  if (rows.size() < listed)
    left_out.add(label,
                 fmt::format("{} of {} rows, the first because: {}", listed - rows.size(), listed, reason));
  return rows;
}

/// Writes can_bus/<scene>_<part>.json; nothing where there are no rows.
template <typename Row>
void writePart(const std::filesystem::path& dataroot, std::string_view scene, std::string_view part,
               const std::vector<Row>& rows) {
  if (rows.empty()) return;
  JsonTableWriter file(dataroot / fmt::format("can_bus/{}_{}.json", scene, part));
  for (const Row& row : rows) {
    file.record().set("utime", row.timestamp_us);
    forEachCanField(row, [&](std::string_view name, const auto& value) { file.set(name, value); });
  }
  file.finish();
}

}  // namespace

double rearAxleSpeed(const CanVehicleInfo& info) noexcept {
  const double mean_rpm = 0.5 * (info.rear_left_rpm + info.rear_right_rpm);
  return mean_rpm * 2.0 * kPi * kZoeWheelRadius / 60.0;
}

std::vector<CanVehicleInfo> readVehicleInfo(const std::filesystem::path& dataroot, std::string_view scene,
                                            const LeftOut& left_out) {
  return readPart<CanVehicleInfo>(dataroot, scene, "zoe_veh_info", left_out);
}

CanBus readCanBus(const std::filesystem::path& dataroot, std::string_view scene, const LeftOut& left_out) {
  return {readPart<CanPose>(dataroot, scene, "pose", left_out),
          readPart<CanImu>(dataroot, scene, "ms_imu", left_out), readVehicleInfo(dataroot, scene, left_out)};
}

void writeCanBus(const std::filesystem::path& dataroot, std::string_view scene, const CanBus& can_bus) {
  writePart(dataroot, scene, "pose", can_bus.poses);
  writePart(dataroot, scene, "ms_imu", can_bus.imu);
  writePart(dataroot, scene, "zoe_veh_info", can_bus.vehicle);
}

}  // namespace radar_dot::dataset
