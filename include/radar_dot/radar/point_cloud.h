// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace radar_dot {

/// Scalar types of a point field; the numbers are those of sensor_msgs/PointField.
enum class ScalarType : std::uint8_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
};

/// Bytes of one scalar of this type; 0 for a value outside the enumeration.
std::size_t scalarSize(ScalarType type) noexcept;

namespace detail {
template <typename T>
double load(const std::uint8_t* data) noexcept {
  T value;
  std::memcpy(&value, data, sizeof value);
  return static_cast<double>(value);
}
}  // namespace detail

/// Reads one scalar (native byte order, any alignment) and widens it. Inline: it is called for every field of
/// every return.
inline double readScalar(const std::uint8_t* data, ScalarType type) noexcept {
  switch (type) {
    case ScalarType::kInt8: return detail::load<std::int8_t>(data);
    case ScalarType::kUint8: return detail::load<std::uint8_t>(data);
    case ScalarType::kInt16: return detail::load<std::int16_t>(data);
    case ScalarType::kUint16: return detail::load<std::uint16_t>(data);
    case ScalarType::kInt32: return detail::load<std::int32_t>(data);
    case ScalarType::kUint32: return detail::load<std::uint32_t>(data);
    case ScalarType::kFloat32: return detail::load<float>(data);
    case ScalarType::kFloat64: return detail::load<double>(data);
  }
  return 0.0;
}

/// One named column of a point cloud.
struct PointField {
  std::string name;
  std::uint32_t offset = 0;  ///< bytes from the start of a point
  ScalarType type = ScalarType::kFloat32;
  std::uint32_t count = 1;  ///< scalars per point
};

inline bool operator==(const PointField& a, const PointField& b) {
  return a.name == b.name && a.offset == b.offset && a.type == b.type && a.count == b.count;
}

/// A cloud of `size()` records that the caller owns: the common ground of sensor_msgs/PointCloud2
/// and of the files of a dataset. Rows of an organised cloud may be padded (`row_step`).
struct PointCloudView {
  const std::vector<PointField>* fields = nullptr;
  const std::uint8_t* data = nullptr;
  std::size_t point_step = 0;  ///< bytes from one point to the next
  std::size_t width = 0;       ///< points per row
  std::size_t height = 1;      ///< rows
  std::size_t row_step = 0;    ///< bytes from one row to the next

  std::size_t size() const noexcept { return width * height; }
  /// Start of point `index`, which must be below size().
  const std::uint8_t* point(std::size_t index) const noexcept {
    return height == 1 ? data + index * point_step
                       : data + (index / width) * row_step + (index % width) * point_step;
  }
};

/// An owned, densely packed cloud with one row.
struct PointCloud {
  std::vector<PointField> fields;
  std::size_t point_step = 0;  ///< bytes per point
  std::size_t size = 0;        ///< number of points
  std::vector<std::uint8_t> data;

  PointCloudView view() const noexcept {
    return {&fields, data.data(), point_step, size, 1, point_step * size};
  }
};

/// The field called `name`, or nullptr.
const PointField* findField(const std::vector<PointField>& fields, std::string_view name) noexcept;

/// The same, and where there is none of exactly this name, the first that differs from it by case alone.
const PointField* findFieldAnyCase(const std::vector<PointField>& fields, std::string_view name) noexcept;

/// The first of these names that the fields have, as findFieldAnyCase(); null: none.
const PointField* findFirstField(const std::vector<PointField>& fields,
                                 std::initializer_list<const char*> names) noexcept;

/// Why this field cannot be read from points of `point_step` bytes; empty: it can.
std::string defectOf(const PointField& field, std::size_t point_step);

/// "x, y, z, rcs": for messages.
std::string fieldNames(const std::vector<PointField>& fields);

}  // namespace radar_dot
