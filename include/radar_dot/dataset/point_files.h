// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "radar_dot/radar/point_cloud.h"

namespace radar_dot::dataset {

/// Reads a .pcd file (DATA ascii, binary or binary_compressed, COUNT 1) with whatever fields, order and types
/// its header declares. POINTS decides how many records there are: nuScenes pads its files with zeros. Zero
/// points are a valid cloud.
/// @throws DatasetError naming file and header line, or the record at which the data end, or behind which
/// they
///         go on with anything but zeros.
PointCloud readPcd(const std::filesystem::path& file);
/// The same of a radar, with a field that may be a velocity. @throws DatasetError for other files
PointCloud readRadarPcd(const std::filesystem::path& file);

/// Reads a LIDAR_TOP .pcd.bin file: records of five float32 x, y, z (m, sensor frame), intensity
/// (0..255), ring.
/// @throws DatasetError when the size is no multiple of a record, a point is not finite or its ring no whole
/// number
///         (records of other sizes show by that), or all is zero.
PointCloud readLidarBin(const std::filesystem::path& file);

/// One return, with the 18 fields of a nuScenes radar file. Sensor frame.
struct RadarRecord {
  float x = 0.0F, y = 0.0F, z = 0.0F;  ///< m
  std::int8_t dyn_prop = 0;
  std::int16_t id = 0;
  float rcs = 0.0F;                      ///< dBsm
  float vx = 0.0F, vy = 0.0F;            ///< m/s, relative to the sensor; not radial
  float vx_comp = 0.0F, vy_comp = 0.0F;  ///< m/s, over ground
  std::int8_t is_quality_valid = 0;
  std::int8_t ambig_state = 0;
  std::int8_t x_rms = 0, y_rms = 0;
  std::int8_t invalid_state = 0;
  std::int8_t pdh0 = 0;
  std::int8_t vx_rms = 0, vy_rms = 0;
};

/// Writes a radar file with the header and the 43-byte records of nuScenes, but without its padding up to
/// a page. No records become one record of NaN, as in nuScenes, whose own reader takes no file without
/// any.
/// @throws DatasetError naming the file where it cannot be written.
void writeRadarPcd(const std::filesystem::path& file, const std::vector<RadarRecord>& records);

/// One point of a LIDAR_TOP file. Sensor frame.
struct LidarRecord {
  float x = 0.0F, y = 0.0F, z = 0.0F;  ///< m
  float intensity = 0.0F;              ///< 0..255
  float ring = 0.0F;                   ///< number of the beam, 0..31
};

/// Writes a LIDAR_TOP .pcd.bin file, the inverse of readLidarBin.
/// @throws DatasetError naming the file where it cannot be written.
void writeLidarBin(const std::filesystem::path& file, const std::vector<LidarRecord>& records);

}  // namespace radar_dot::dataset
