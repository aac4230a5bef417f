// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "output_file.h"
#include "radar_dot/dataset/point_files.h"

namespace radar_dot::dataset {
namespace {

template <typename Scalar>
void append(OutputFile& file, Scalar value) {
  file.write({reinterpret_cast<const char*>(&value), sizeof value});
}

void append(OutputFile& file, const RadarRecord& record) {
  const auto& r = record;
  for (const float value : {r.x, r.y, r.z}) append(file, value);
  append(file, r.dyn_prop);
  append(file, r.id);
  for (const float value : {r.rcs, r.vx, r.vy, r.vx_comp, r.vy_comp}) append(file, value);
  for (const std::int8_t value :
       {r.is_quality_valid, r.ambig_state, r.x_rms, r.y_rms, r.invalid_state, r.pdh0, r.vx_rms, r.vy_rms})
    append(file, value);
}

/// What stands for a scan without returns in nuScenes.
RadarRecord emptyScan() {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  RadarRecord record;
  for (float* value : {&record.x, &record.y, &record.z, &record.rcs, &record.vx, &record.vy, &record.vx_comp,
                       &record.vy_comp})
    *value = kNone;
  return record;
}

}  // namespace

void writeRadarPcd(const std::filesystem::path& file, const std::vector<RadarRecord>& records) {
  if (records.empty()) return writeRadarPcd(file, {emptyScan()});
  OutputFile output(file);
  output.write(fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "VERSION 0.7\n"
      "FIELDS x y z dyn_prop id rcs vx vy vx_comp vy_comp is_quality_valid ambig_state x_rms y_rms "
      "invalid_state pdh0 vx_rms vy_rms\n"
      "SIZE 4 4 4 1 2 4 4 4 4 4 1 1 1 1 1 1 1 1\n"
      "TYPE F F F I I F F F F F I I I I I I I I\n"
      "COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"
      "WIDTH {0}\n"
      "HEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS {0}\n"
      "DATA binary\n",
      records.size()));
  for (const RadarRecord& record : records) append(output, record);
  output.close();
}

void writeLidarBin(const std::filesystem::path& file, const std::vector<LidarRecord>& records) {
  OutputFile output(file);
  for (const LidarRecord& r : records)
    for (const float value : {r.x, r.y, r.z, r.intensity, r.ring}) append(output, value);
  output.close();
}

}  // namespace radar_dot::dataset
