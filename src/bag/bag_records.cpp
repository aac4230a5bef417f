// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_records.h"

#include <fmt/format.h>

#include <boost/interprocess/file_mapping.hpp>
#include <boost/interprocess/mapped_region.hpp>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <unordered_set>

namespace radar_dot::bag {
namespace {

// wiki.ros.org/Bags/Format/2.0
constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
constexpr std::uint64_t kMostPerByte = 100000;  // that a compressed byte stands for; bzip2's zeros: 45000
enum Operation : char { kFileHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

void expect(bool right) {
  if (!right) throw std::runtime_error("broken");
}

template <typename T>
T take(std::string_view& rest) {
  T number;
  expect(rest.size() >= sizeof number);
  std::memcpy(&number, rest.data(), sizeof number);
  rest.remove_prefix(sizeof number);
  return number;
}

/// A length, and as many bytes.
std::string_view takeBlock(std::string_view& rest) {
  const auto length = take<std::uint32_t>(rest);
  expect(length <= rest.size());
  const std::string_view block = rest.substr(0, length);
  rest.remove_prefix(length);
  return block;
}

/// Looks at all fields of a header.
std::string_view valueOf(std::string_view header, std::string_view name) {
  std::string_view value;
  while (!header.empty()) {
    const std::string_view field = takeBlock(header);
    const std::size_t equals = field.find('=');
    expect(equals != std::string_view::npos);
    if (field.substr(0, equals) == name) value = field.substr(equals + 1);
  }
  return value;
}

template <typename T>
T numberIn(std::string_view header, std::string_view name) {
  std::string_view value = valueOf(header, name);
  return take<T>(value);
}

/// `position` is that of the record at hand.
void check(std::string_view file, std::size_t& position) {
  std::unordered_set<std::uint64_t> chunks,
      messages;  // where they begin; messages of a chunk that is not compressed
  std::uint64_t index = 0, size = 0;
  bool has_index = false;
  for (std::string_view rest = file.substr(position); !rest.empty(); position = file.size() - rest.size()) {
    const std::string_view header = takeBlock(rest);
    std::string_view data = takeBlock(rest);
    const char operation = numberIn<char>(header, "op");
    if (operation == kFileHeader) {
      index = numberIn<std::uint64_t>(header, "index_pos");
      if (index == 0) return;
    } else if (operation == kChunk) {
      chunks.insert(position);
      messages.clear();
      size = numberIn<std::uint32_t>(header, "size");
      const bool compressed = valueOf(header, "compression") != "none";
      expect(compressed ? size / kMostPerByte <= data.size() : size == data.size());
      for (; !compressed && !data.empty(); takeBlock(data)) {
        messages.insert(size - data.size());
        valueOf(takeBlock(data), {});
      }
    } else if (operation == kIndex) {
      while (!data.empty()) {
        take<std::uint64_t>(data);  // the time
        const auto place = take<std::uint32_t>(data);
        expect(messages.empty() ? place < size : messages.count(place) > 0);
      }
    } else if (operation == kChunkInfo) {
      expect(chunks.count(numberIn<std::uint64_t>(header, "chunk_pos")) > 0);
    } else {
      expect(operation == kConnection);
      valueOf(data, {});
    }
    has_index |= position == index;
  }
  expect(has_index || index == file.size());
}

}  // namespace

void checkBagRecords(const std::filesystem::path& path) {
  namespace ipc = boost::interprocess;
  if (std::filesystem::file_size(path) <= kVersion.size()) return;
  const ipc::mapped_region region(ipc::file_mapping(path.c_str(), ipc::read_only), ipc::read_only);
  const std::string_view file(static_cast<const char*>(region.get_address()), region.get_size());
  if (file.substr(0, kVersion.size()) != kVersion) return;
  std::size_t position = kVersion.size();
  try {
    check(file, position);
  } catch (const std::runtime_error&) {
    throw std::runtime_error(fmt::format("broken at byte {} of {}", position, file.size()));
  }
}

}  // namespace radar_dot::bag
