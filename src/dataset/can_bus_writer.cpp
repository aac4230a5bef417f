// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "json_table_writer.h"
#include "radar_dot/dataset/can_bus.h"

namespace radar_dot::dataset {
namespace {

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
