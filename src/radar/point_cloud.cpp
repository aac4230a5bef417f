// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/point_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace radar_dot {

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

const PointField* findFirstField(const std::vector<PointField>& fields,
                                 std::initializer_list<const char*> names) noexcept {
  const PointField* found = nullptr;
  for (auto name = names.begin(); name != names.end() && found == nullptr; ++name)
    found = findFieldAnyCase(fields, *name);
  return found;
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
