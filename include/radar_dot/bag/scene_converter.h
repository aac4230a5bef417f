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

#include "radar_dot/dataset/tables.h"

namespace radar_dot::bag {

enum class Compression : std::uint8_t { kNone, kLz4, kBz2 };

/// Parameters of convertScene.
struct ConvertOptions {
  std::vector<std::string> channels;  ///< empty = every channel the scene has
  Compression compression = Compression::kNone;
  bool overwrite = false;
  bool masks = true;  ///< ground-truth dynamic masks, where nuinsseg.json is there
};

/// What a conversion did.
struct ConvertSummary {
  std::filesystem::path file;
  std::size_t messages = 0;
  std::size_t radar_files = 0;
  std::uintmax_t sensor_bytes = 0;  ///< of the sensor files put into the bag
  std::uintmax_t bag_bytes = 0;
  /// Files the tables list and the disk lacks, by channel: (missing, listed).
  std::map<std::string, std::pair<std::size_t, std::size_t>> missing;
};

/// Called with the readings done and the readings in all.
using ProgressCallback = std::function<void(std::size_t, std::size_t)>;

/// Writes one scene to `folder/<scene>.bag`, messages in order of time. The bag appears under its
/// name only when it is complete.
/// @throws dataset::DatasetError for unreadable input; std::runtime_error with path and cause when
///         the bag cannot be written or exists and may not be overwritten. Nothing stays behind.
ConvertSummary convertScene(const dataset::Tables& tables, dataset::Index scene,
                            const std::filesystem::path& folder, const ConvertOptions& options = {},
                            const ProgressCallback& progress = {});

}  // namespace radar_dot::bag
