// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace radar_dot::dataset {

/// Reads a whole file. @throws DatasetError naming the file where it cannot be read.
std::vector<std::uint8_t> readBytes(const std::filesystem::path& file);

/// Writes a whole file. @throws DatasetError naming the file where it cannot be written.
void writeBytes(const std::filesystem::path& file, const void* data, std::size_t size);

}  // namespace radar_dot::dataset
