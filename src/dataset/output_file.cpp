// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

OutputFile::OutputFile(std::filesystem::path file)
    : path_(std::move(file)), stream_(std::fopen(path_.c_str(), "wb"), &std::fclose) {
  if (!stream_) fail(errno);
  // One buffer is enough, and with our own a failed write is noticed while errno still tells why.
  std::setvbuf(stream_.get(), nullptr, _IONBF, 0);
  buffer_.reserve(kBufferSize);
}

void OutputFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > kBufferSize) flush();
  buffer_.append(bytes);
}

void OutputFile::close() {
  flush();
  if (std::fclose(stream_.release()) != 0) fail(errno);
}

void OutputFile::flush() {
  if (std::fwrite(buffer_.data(), 1, buffer_.size(), stream_.get()) != buffer_.size()) fail(errno);
  buffer_.clear();
}

void OutputFile::fail(int cause) const {
  throw DatasetError(
      fmt::format("{}: cannot write: {}", path_.string(), std::generic_category().message(cause)));
}

}  // namespace radar_dot::dataset
