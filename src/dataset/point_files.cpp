// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/point_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "output_file.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

std::optional<ScalarType> scalarType(std::string_view type_and_size) {
  constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"I1", ScalarType::kInt8},    {"U1", ScalarType::kUint8},  {"I2", ScalarType::kInt16},
      {"U2", ScalarType::kUint16},  {"I4", ScalarType::kInt32},  {"U4", ScalarType::kUint32},
      {"F4", ScalarType::kFloat32}, {"F8", ScalarType::kFloat64}};
  for (const auto& [name, type] : kTypes)
    if (name == type_and_size) return type;
  return std::nullopt;
}

/// Goes through the lines up to DATA and then puts their entries together.
class PcdHeader {
 public:
  PcdHeader(std::string_view content, const std::filesystem::path& file) : content_(content), file_(file) {
    while (entries_.find("DATA") == entries_.end()) parseLine(nextLine());
    if (const Entry& data = entry("DATA"); data.values != std::vector<std::string_view>{"binary"})
      fail(data.line, "DATA must be binary; convert the file (pcl_convert_pcd_ascii_binary IN OUT 1)");
  }

  /// Bytes; where the records start.
  std::size_t size() const noexcept { return position_; }

  /// The fields and the number of points; no data.
  PointCloud emptyCloud() const {
    PointCloud cloud;
    const Entry& names = entry("FIELDS");
    if (names.values.empty()) fail(names.line, "there are no fields");
    for (const char* name : {"SIZE", "TYPE", "COUNT"}) {
      if (entry(name).values.size() != names.values.size())
        fail(entry(name).line, fmt::format("{} has {} values for {} FIELDS", name, entry(name).values.size(),
                                           names.values.size()));
    }
    for (std::size_t i = 0; i < names.values.size(); ++i) {
      const std::string_view size = entry("SIZE").values[i], type = entry("TYPE").values[i];
      const auto scalar = scalarType(std::string(type).append(size));
      if (!scalar)
        fail(entry("TYPE").line,
             fmt::format("field '{}' has TYPE {} of SIZE {}", names.values[i], type, size));
      if (entry("COUNT").values[i] != "1")
        fail(entry("COUNT").line,
             fmt::format("field '{}' has COUNT {}, must be 1", names.values[i], entry("COUNT").values[i]));
      if (findField(cloud.fields, names.values[i]) != nullptr)
        fail(names.line, fmt::format("field '{}' appears twice", names.values[i]));
      cloud.fields.push_back(
          {std::string(names.values[i]), static_cast<std::uint32_t>(cloud.point_step), *scalar, 1});
      cloud.point_step += scalarSize(*scalar);
    }
    cloud.size = number("POINTS");
    if (number("WIDTH") * number("HEIGHT") != cloud.size)
      fail(entry("POINTS").line, fmt::format("POINTS is {} but WIDTH x HEIGHT is {}", cloud.size,
                                             number("WIDTH") * number("HEIGHT")));
    return cloud;
  }

 private:
  struct Entry {
    std::vector<std::string_view> values;
    std::size_t line = 0;
  };

  [[noreturn]] void fail(std::size_t line, std::string_view complaint) const {
    throw DatasetError(fmt::format("{}: header line {}: {}", file_.string(), line, complaint));
  }

  std::string_view nextLine() {
    const std::size_t end = content_.find('\n', position_);
    if (end == std::string_view::npos)
      throw DatasetError(
          fmt::format("{}: no DATA line, so this is no PCD file or only the start of one", file_.string()));
    const std::string_view line = content_.substr(position_, end - position_);
    position_ = end + 1;
    ++line_;
    return line;
  }

  void parseLine(std::string_view line) {
    constexpr std::string_view kKeywords[] = {"VERSION", "FIELDS",    "SIZE",   "TYPE",   "COUNT",
                                              "WIDTH",   "VIEWPOINT", "HEIGHT", "POINTS", "DATA"};
    std::vector<std::string_view> words;
    for (std::size_t start = line.find_first_not_of(" \t\r"); start != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
      words.push_back(line.substr(start, end - start));
      start = line.find_first_not_of(" \t\r", end);
    }
    if (words.empty() || words[0][0] == '#') return;
    if (std::find(std::begin(kKeywords), std::end(kKeywords), words[0]) == std::end(kKeywords))
      fail(line_, fmt::format("'{}' is no entry of a PCD header", printable(words[0])));
    entries_[words[0]] = {{words.begin() + 1, words.end()}, line_};
  }

  const Entry& entry(std::string_view name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) fail(line_, fmt::format("the header has no {}", name));
    return found->second;
  }

  std::size_t number(std::string_view name) const {
    constexpr std::size_t kMostDigits = 9;
    const Entry& found = entry(name);
    const std::string text(found.values.size() == 1 ? found.values[0] : "");
    if (text.empty() || text.size() > kMostDigits ||
        text.find_first_not_of("0123456789") != std::string::npos)
      fail(found.line, fmt::format("{} must be one whole number", name));
    return std::strtoul(text.c_str(), nullptr, 10);
  }

  static std::string printable(std::string_view text) {
    std::string shown(text.substr(0, 20));
    for (char& letter : shown)
      if (letter < ' ' || letter > '~') letter = '?';
    return shown;
  }

  std::string_view content_;
  const std::filesystem::path& file_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::map<std::string_view, Entry> entries_;
};

template <typename Scalar>
void append(OutputFile& file, Scalar value) {
  file.write({reinterpret_cast<const char*>(&value), sizeof value});
}

void append(OutputFile& file, const RadarRecord& record) {
  const auto& r = record;
  for (const float value : {r.x, r.y, r.z}) append(file, value);
  append(file, r.dyn_prop);
  append(file, r.id);
  for (const float value : {r.rcs, r.vx, r.vy, r.vx_comp, r.vy_comp}) append(file, value);
  for (const std::int8_t value :
       {r.is_quality_valid, r.ambig_state, r.x_rms, r.y_rms, r.invalid_state, r.pdh0, r.vx_rms, r.vy_rms})
    append(file, value);
}

/// What stands for a scan without returns in nuScenes.
RadarRecord emptyScan() {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  RadarRecord record;
  for (float* value : {&record.x, &record.y, &record.z, &record.rcs, &record.vx, &record.vy, &record.vx_comp,
                       &record.vy_comp})
    *value = kNone;
  return record;
}

}  // namespace

PointCloud readPcd(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = readBytes(file);
  const PcdHeader header({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
  PointCloud cloud = header.emptyCloud();
  const std::size_t available = (bytes.size() - header.size()) / cloud.point_step;
  if (available < cloud.size)
    throw DatasetError(
        fmt::format("{}: the data end in record {} of {} (counted from 0); the file is incomplete, "
                    "extract it again",
                    file.string(), available, cloud.size));
  const std::uint8_t* records = bytes.data() + header.size();
  cloud.data.assign(records, records + cloud.size * cloud.point_step);
  return cloud;
}

PointCloud readLidarBin(const std::filesystem::path& file) {
  PointCloud cloud;
  for (const char* name : {"x", "y", "z", "intensity", "ring"}) {
    cloud.fields.push_back({name, static_cast<std::uint32_t>(cloud.point_step), ScalarType::kFloat32, 1});
    cloud.point_step += sizeof(float);
  }
  cloud.data = readBytes(file);
  if (cloud.data.size() % cloud.point_step != 0)
    throw DatasetError(
        fmt::format("{}: {} bytes are no multiple of a record of {} (five float32); is the file complete?",
                    file.string(), cloud.data.size(), cloud.point_step));
  cloud.size = cloud.data.size() / cloud.point_step;
  return cloud;
}

void writeRadarPcd(const std::filesystem::path& file, const std::vector<RadarRecord>& records) {
  if (records.empty()) return writeRadarPcd(file, {emptyScan()});
  OutputFile output(file);
  output.write(fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\n"
      "VERSION 0.7\n"
      "FIELDS x y z dyn_prop id rcs vx vy vx_comp vy_comp is_quality_valid ambig_state x_rms y_rms "
      "invalid_state pdh0 vx_rms vy_rms\n"
      "SIZE 4 4 4 1 2 4 4 4 4 4 1 1 1 1 1 1 1 1\n"
      "TYPE F F F I I F F F F F I I I I I I I I\n"
      "COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"
      "WIDTH {0}\n"
      "HEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS {0}\n"
      "DATA binary\n",
      records.size()));
  for (const RadarRecord& record : records) append(output, record);
  output.close();
}

void writeLidarBin(const std::filesystem::path& file, const std::vector<LidarRecord>& records) {
  OutputFile output(file);
  for (const LidarRecord& r : records)
    for (const float value : {r.x, r.y, r.z, r.intensity, r.ring}) append(output, value);
  output.close();
}

}  // namespace radar_dot::dataset
