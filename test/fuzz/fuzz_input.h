// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace radar_dot::test {

/// What a fuzzer makes up, taken apart from the front; zeros and nothing once it is at its end. ByteWriter
/// puts it together.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : bytes_(reinterpret_cast<const char*>(data), size) {}

  template <typename Number>
  Number number() {
    Number value{};
    const std::string_view bytes = take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }
  std::string text() { return std::string(take(number<std::uint8_t>())); }
  std::string_view rest() { return take(bytes_.size()); }

 private:
  std::string_view take(std::size_t size) {
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(taken.size());
    return taken;
  }

  std::string_view bytes_;
};

class ByteWriter {
 public:
  template <typename Number>
  ByteWriter& number(Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  ByteWriter& text(std::string_view text) {
    number(static_cast<std::uint8_t>(text.size()));
    return rest(text);
  }
  ByteWriter& rest(std::string_view rest) {
    bytes += rest;
    return *this;
  }

  std::string bytes;
};

/// An input as a file, in memory alone.
class InputFile {
 public:
  InputFile() : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
  }
  ~InputFile() { ::close(descriptor_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }
  void set(std::string_view content) {
    if (::ftruncate(descriptor_, 0) != 0 ||
        ::pwrite(descriptor_, content.data(), content.size(), 0) != static_cast<ssize_t>(content.size()))
      throw std::runtime_error("no memory for a file");
  }

 private:
  int descriptor_;
  std::filesystem::path path_;
};

/// Every other exception than the one that the function's documentation names is a defect.
template <typename Refusal, typename Call>
void mayRefuse(const Call& call) {
  try {
    call();
  } catch (const Refusal&) {
  }
}

/// What holds of everything that is accepted.
inline void expect(bool holds) {
  if (!holds) std::abort();
}

}  // namespace radar_dot::test
