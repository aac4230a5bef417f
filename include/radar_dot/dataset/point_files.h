// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "radar_dot/radar/point_cloud.h"

namespace radar_dot::dataset {

/// Reads a .pcd file (DATA binary or ascii) with whatever fields, order and types its header
/// declares, and packs them without gaps. POINTS decides how many records there are: nuScenes pads
/// its files with zeros. Zero points are a valid cloud.
/// @throws DatasetError naming file and header line, or the record at which the data end.
PointCloud readPcd(const std::filesystem::path& file);

/// Reads a LIDAR_TOP .pcd.bin file: records of five float32 x, y, z (m, sensor frame), intensity
/// (0..255), ring.
/// @throws DatasetError when the size is no multiple of a record.
PointCloud readLidarBin(const std::filesystem::path& file);

}  // namespace radar_dot::dataset
