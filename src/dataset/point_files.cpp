// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/point_files.h"

#include <fmt/format.h>
#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "pcd_header.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

/// One read without a buffer in between: the files are small and many.
std::vector<std::uint8_t> readBytes(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream)
    throw DatasetError(
        fmt::format("{}: cannot open; was this part of the dataset extracted?", file.string()));
  std::setvbuf(stream.get(), nullptr, _IONBF, 0);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw DatasetError(fmt::format("{}: {}", file.string(), error.message()));
  std::vector<std::uint8_t> bytes(size);
  if (std::fread(bytes.data(), 1, bytes.size(), stream.get()) != bytes.size())
    throw DatasetError(fmt::format("{}: cannot read all of its {} bytes", file.string(), bytes.size()));
  return bytes;
}

[[noreturn]] void failTruncated(const std::filesystem::path& file, std::size_t record, std::size_t points) {
  throw DatasetError(
      fmt::format("{}: the data end in record {} of {} (counted from 0); the file is incomplete, "
                  "extract it again",
                  file.string(), record, points));
}

/// The cloud a header describes, without gaps and still without data.
PointCloud emptyCloud(const PcdHeader& header) {
  PointCloud cloud;
  cloud.size = header.points;
  for (const PcdColumn& column : header.columns) {
    if (column.is_gap) continue;
    cloud.fields.push_back(column.field);
    cloud.fields.back().offset = static_cast<std::uint32_t>(cloud.point_step);
    cloud.point_step += column.bytes();
  }
  return cloud;
}

void readBinary(const PcdHeader& header, const std::vector<std::uint8_t>& bytes,
                const std::filesystem::path& file, PointCloud& cloud) {
  const std::size_t available = (bytes.size() - header.data_offset) / header.record_size;
  if (available < header.points) failTruncated(file, available, header.points);
  const std::uint8_t* record = bytes.data() + header.data_offset;
  if (cloud.point_step == header.record_size) {
    cloud.data.assign(record, record + header.points * header.record_size);
    return;
  }
  cloud.data.reserve(cloud.size * cloud.point_step);
  for (std::size_t i = 0; i < header.points; ++i, record += header.record_size) {
    for (const PcdColumn& column : header.columns) {
      const std::uint8_t* start = record + column.field.offset;
      if (!column.is_gap) cloud.data.insert(cloud.data.end(), start, start + column.bytes());
    }
  }
}

/// The "C" locale, so that a decimal point is one whatever the program's own locale says.
class PlainLocale {
 public:
  PlainLocale() : locale_(newlocale(LC_ALL_MASK, "C", nullptr)) {}
  ~PlainLocale() { freelocale(locale_); }
  PlainLocale(const PlainLocale&) = delete;
  PlainLocale& operator=(const PlainLocale&) = delete;
  double parse(const char* text, char** end) const { return strtod_l(text, end, locale_); }

 private:
  locale_t locale_;
};

template <typename T>
bool append(std::vector<std::uint8_t>& data, double value) {
  if constexpr (std::is_integral_v<T>) {
    // Not-a-number fails this, too.
    if (!(value >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
          value <= static_cast<double>(std::numeric_limits<T>::max())))
      return false;
  }
  const T scalar = static_cast<T>(value);
  const auto* start = reinterpret_cast<const std::uint8_t*>(&scalar);
  data.insert(data.end(), start, start + sizeof scalar);
  return true;
}

bool appendScalar(std::vector<std::uint8_t>& data, ScalarType type, double value) {
  switch (type) {
    case ScalarType::kInt8: return append<std::int8_t>(data, value);
    case ScalarType::kUint8: return append<std::uint8_t>(data, value);
    case ScalarType::kInt16: return append<std::int16_t>(data, value);
    case ScalarType::kUint16: return append<std::uint16_t>(data, value);
    case ScalarType::kInt32: return append<std::int32_t>(data, value);
    case ScalarType::kUint32: return append<std::uint32_t>(data, value);
    case ScalarType::kFloat32: return append<float>(data, value);
    case ScalarType::kFloat64: return append<double>(data, value);
  }
  return false;
}

void readAscii(const PcdHeader& header, std::vector<std::uint8_t>& bytes, const std::filesystem::path& file,
               PointCloud& cloud) {
  const PlainLocale locale;
  bytes.push_back(0);  // where strtod stops at the latest
  const char* text = reinterpret_cast<const char*>(bytes.data()) + header.data_offset;
  for (std::size_t record = 0; record < header.points; ++record) {
    for (const PcdColumn& column : header.columns) {
      for (std::uint32_t i = 0; i < column.field.count; ++i) {
        text += std::strspn(text, " \t\r\n");
        if (*text == 0) failTruncated(file, record, header.points);
        char* end = nullptr;
        const double value = locale.parse(text, &end);
        const std::size_t length = std::strcspn(text, " \t\r\n");
        const bool is_number = end == text + length;
        if (!is_number || (!column.is_gap && !appendScalar(cloud.data, column.field.type, value)))
          throw DatasetError(
              fmt::format("{}: record {} (counted from 0): '{}' does not fit field '{}'", file.string(),
                          record, std::string(text, std::min<std::size_t>(length, 40)), column.field.name));
        text = end;
      }
    }
  }
}

}  // namespace

PointCloud readPcd(const std::filesystem::path& file) {
  std::vector<std::uint8_t> bytes = readBytes(file);
  const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const PcdHeader header = parsePcdHeader(content, file);
  PointCloud cloud = emptyCloud(header);
  if (header.encoding == PcdEncoding::kBinary)
    readBinary(header, bytes, file, cloud);
  else
    readAscii(header, bytes, file, cloud);
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

}  // namespace radar_dot::dataset
