// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "radar_dot/radar/point_cloud.h"

namespace radar_dot::dataset {

enum class PcdEncoding { kBinary, kAscii };

/// A column of a PCD file. Columns called "_" are gaps: read over, and not part of the cloud.
struct PcdColumn {
  PointField field;  ///< offset: bytes from the start of a record in the file, as binary
  bool is_gap = false;

  std::size_t bytes() const noexcept { return scalarSize(field.type) * field.count; }
};

/// What the text in front of the records says.
struct PcdHeader {
  std::vector<PcdColumn> columns;
  std::size_t record_size = 0;  ///< bytes of a binary record
  std::size_t points = 0;
  PcdEncoding encoding = PcdEncoding::kBinary;
  std::size_t data_offset = 0;  ///< bytes; where the records start
};

/// @throws DatasetError naming file and header line.
PcdHeader parsePcdHeader(std::string_view content, const std::filesystem::path& file);

}  // namespace radar_dot::dataset
