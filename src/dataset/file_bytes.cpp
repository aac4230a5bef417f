// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/file_bytes.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string_view>
#include <system_error>

#include "output_file.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

std::vector<std::uint8_t> readBytes(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream)
    throw DatasetError(
        fmt::format("{}: cannot open; was this part of the dataset extracted?", file.string()));
  std::setvbuf(stream.get(), nullptr, _IONBF, 0);  // one read: the files are small and many
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw DatasetError(fmt::format("{}: {}", file.string(), error.message()));
  std::vector<std::uint8_t> bytes(size);
  if (std::fread(bytes.data(), 1, bytes.size(), stream.get()) != bytes.size())
    throw DatasetError(fmt::format("{}: cannot read all of its {} bytes", file.string(), bytes.size()));
  return bytes;
}

void writeBytes(const std::filesystem::path& file, const void* data, std::size_t size) {
  OutputFile output(file);
  output.write(std::string_view(static_cast<const char*>(data), size));
  output.close();
}

}  // namespace radar_dot::dataset
