// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "bag/bag_reading.h"

#include <sstream>
#include <stdexcept>

#include "fixtures/files.h"

namespace radar_dot::test {

std::map<std::string, std::size_t> BagReader::counts() {
  std::map<std::string, std::size_t> found;
  for (const rosbag::MessageInstance& message : view_) ++found[message.getTopic()];
  return found;
}

RawPcd readRawPcd(const std::filesystem::path& file) {
  const std::string bytes = readFile(file);
  RawPcd pcd;
  std::istringstream stream(bytes);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "FIELDS") {
      for (RawPcd::Field field; words >> field.name;) pcd.fields.push_back(field);
    } else if (keyword == "SIZE") {
      for (RawPcd::Field& field : pcd.fields) words >> field.size;
    } else if (keyword == "TYPE") {
      for (RawPcd::Field& field : pcd.fields) words >> field.type;
    } else if (keyword == "POINTS") {
      words >> pcd.points;
    } else if (keyword == "DATA") {
      break;
    }
  }
  for (RawPcd::Field& field : pcd.fields) {
    field.offset = pcd.record;
    pcd.record += field.size;
  }
  const auto start = static_cast<std::size_t>(stream.tellg());
  if (bytes.size() < start + pcd.points * pcd.record) throw std::runtime_error(file.string() + ": too short");
  pcd.data = bytes.substr(start, pcd.points * pcd.record);
  return pcd;
}

std::int64_t microseconds(const ros::Time& time) {
  if (time.nsec % 1000U != 0) throw std::runtime_error("a stamp with nanoseconds");
  return static_cast<std::int64_t>(time.sec) * 1'000'000 + time.nsec / 1000U;
}

}  // namespace radar_dot::test
