// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace radar_dot::dataset {

/// A file being written, whose every failure (no permission, disk full) is a DatasetError that names
/// it. A file without close() is incomplete.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);

  void put(char character) {
    if (buffer_.size() == kBufferSize) flush();
    buffer_.push_back(character);
  }
  void write(std::string_view bytes);
  void close();

 private:
  static constexpr std::size_t kBufferSize = 1 << 16;

  void flush();
  [[noreturn]] void fail(int cause) const;

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  std::string buffer_;
};

}  // namespace radar_dot::dataset
