// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "radar_dot/bag/bag_file.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::bag {

/// Parameters of convertScene.
struct ConvertOptions {
  std::vector<std::string> channels;  ///< empty = every channel the scene has
  Compression compression = Compression::kNone;
  bool overwrite = false;  ///< otherwise a bag that is complete stays
  /// What dataset::readInstanceMasks gave, for the ground-truth dynamic masks, which go with
  /// their cameras; nullptr = no masks.
  const std::vector<dataset::InstanceMask>* masks = nullptr;
};

/// Sensor files the tables list.
struct FileCount {
  std::size_t missing = 0;  ///< of them, not on disk
  std::size_t listed = 0;
};

/// What a conversion did.
struct ConvertSummary {
  std::filesystem::path file;
  bool existed = false;  ///< nothing was written: only what was there, and what is missing, is told
  std::size_t messages = 0;
  std::size_t radar_files = 0;
  std::uintmax_t sensor_bytes = 0;  ///< of the sensor files put into the bag
  std::uintmax_t bag_bytes = 0;
  std::map<std::string, FileCount> missing;  ///< by channel, where at least one file is missing
};

/// Called with the readings done and the readings in all. An exception it throws ends the
/// conversion and passes through; nothing stays behind.
using ProgressCallback = std::function<void(std::size_t, std::size_t)>;

/// Writes one scene to `folder/<scene>.bag` (the folder is made when missing), messages in order
/// of time, recorded at the time of their stamp:
///
///     /tf_static                             base_link -> every sensor; latched, 1 us before the rest
///     /<radar channel>, /lidar_top           sensor_msgs/PointCloud2
///     /<camera channel>/image/compressed     sensor_msgs/CompressedImage, bytes of the file
///     /<camera channel>/camera_info          sensor_msgs/CameraInfo, with every image and mask
///     /can/imu                               sensor_msgs/Imu, base_link
///     /can/wheel_speed                       geometry_msgs/TwistWithCovarianceStamped, base_link
///     /ground_truth/odom                     nav_msgs/Odometry map -> base_link, at every ego pose
///     /ground_truth/boxes                    visualization_msgs/MarkerArray in map, at keyframes
///     /ground_truth/dynamic_mask/compressed  sensor_msgs/CompressedImage of CAM_FRONT, see
///     ConvertOptions::masks /ground_truth/<camera channel>/dynamic_mask/compressed  of the other cameras
///
/// Topics and frames of sensors are the channels in lower case.
/// Sensor files that are not on disk are left out and counted. The bag appears under its name only
/// when it is complete, and then is not written again unless it may be overwritten.
/// @throws dataset::DatasetError for unreadable input, when none of the files is on disk, or when the bag
/// exists and
///         is not complete or lacks files that are on disk now;
///         std::invalid_argument for a channel the dataset lacks, with those it has;
///         std::runtime_error with path and cause when the bag cannot be written. Nothing stays behind.
ConvertSummary convertScene(const dataset::Tables& tables, dataset::Index scene,
                            const std::filesystem::path& folder, const ConvertOptions& options = {},
                            const ProgressCallback& progress = {});

}  // namespace radar_dot::bag
