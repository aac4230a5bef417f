// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/point_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

namespace radar_dot {
namespace {

template <typename T>
double load(const std::uint8_t* data) noexcept {
  T value;
  std::memcpy(&value, data, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

std::size_t scalarSize(ScalarType type) noexcept {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8: return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16: return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32: return 4;
    case ScalarType::kFloat64: return 8;
  }
  return 0;
}

double readScalar(const std::uint8_t* data, ScalarType type) noexcept {
  switch (type) {
    case ScalarType::kInt8: return load<std::int8_t>(data);
    case ScalarType::kUint8: return load<std::uint8_t>(data);
    case ScalarType::kInt16: return load<std::int16_t>(data);
    case ScalarType::kUint16: return load<std::uint16_t>(data);
    case ScalarType::kInt32: return load<std::int32_t>(data);
    case ScalarType::kUint32: return load<std::uint32_t>(data);
    case ScalarType::kFloat32: return load<float>(data);
    case ScalarType::kFloat64: return load<double>(data);
  }
  return 0.0;
}

const PointField* findField(const std::vector<PointField>& fields, std::string_view name) noexcept {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [name](const PointField& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

const PointField* findFieldAnyCase(const std::vector<PointField>& fields, std::string_view name) noexcept {
  if (const PointField* exact = findField(fields, name)) return exact;
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const PointField& field) {
    return std::equal(field.name.begin(), field.name.end(), name.begin(), name.end(), same);
  });
  return found == fields.end() ? nullptr : &*found;
}

std::string defectOf(const PointField& field, std::size_t point_step) {
  const std::size_t size = scalarSize(field.type);
  if (size != 0 && field.offset + size <= point_step) return {};
  return fmt::format("field '{}' (offset {}, type {}) does not fit into points of {} bytes", field.name,
                     field.offset, static_cast<int>(field.type), point_step);
}

std::string fieldNames(const std::vector<PointField>& fields) {
  std::string names;
  for (const PointField& field : fields) names += (names.empty() ? "" : ", ") + field.name;
  return names;
}

}  // namespace radar_dot
