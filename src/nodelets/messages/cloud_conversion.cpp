// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/cloud_conversion.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace radar_dot {
namespace {

bool hostIsBigEndian() {
  const std::uint16_t probe = 0x0100;
  std::uint8_t first = 0;
  std::memcpy(&first, &probe, 1);
  return first == 1;
}

sensor_msgs::PointField floatField(const sensor_msgs::PointCloud2& cloud, const std::string& name,
                                   std::uint32_t offset) {
  const bool taken =
      std::any_of(cloud.fields.begin(), cloud.fields.end(),
                  [&name](const sensor_msgs::PointField& field) { return field.name == name; });
  sensor_msgs::PointField field;
  field.name = taken ? "ego_" + name : name;
  field.offset = offset;
  field.datatype = sensor_msgs::PointField::FLOAT32;
  field.count = 1;
  return field;
}

}  // namespace

PointCloudView viewOf(const sensor_msgs::PointCloud2& cloud, std::vector<PointField>& fields) {
  fields.clear();
  for (const sensor_msgs::PointField& field : cloud.fields) {
    fields.push_back({field.name, field.offset, static_cast<ScalarType>(field.datatype), field.count});
  }
  const PointCloudView view{&fields,     cloud.data.data(), cloud.point_step,
                            cloud.width, cloud.height,      cloud.row_step};
  if (view.size() == 0) return view;

  if ((cloud.is_bigendian != 0) != hostIsBigEndian()) {
    throw std::invalid_argument(
        "its data are in the other byte order (is_bigendian); convert them in the driver");
  }
  if (cloud.point_step == 0) throw std::invalid_argument("its point_step is 0");
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  // Drivers of unorganised clouds often leave row_step at 0; with one row it is not needed.
  if (cloud.height > 1 && cloud.row_step < row) {
    throw std::invalid_argument("its row_step of " + std::to_string(cloud.row_step) +
                                " is less than width * point_step = " + std::to_string(row));
  }
  const std::uint64_t needed =
      std::max(row, std::uint64_t{cloud.height} * (cloud.height > 1 ? cloud.row_step : row));
  if (cloud.data.size() < needed) {
    throw std::invalid_argument("it has " + std::to_string(cloud.data.size()) + " bytes of data where its " +
                                std::to_string(view.size()) + " points need " + std::to_string(needed));
  }
  return view;
}

sensor_msgs::PointCloud2ConstPtr withPositions(const sensor_msgs::PointCloud2ConstPtr& cloud, AngleUnit unit,
                                               std::vector<std::string>& faults) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(*cloud, fields);
  const bool has_positions =
      findFieldAnyCase(fields, "x") != nullptr && findFieldAnyCase(fields, "y") != nullptr;
  if (view.size() == 0 || has_positions) return cloud;
  const PointField* const polar[] = {
      findFirstField(fields, {"range", "r"}),
      findFirstField(fields, {"azimuth", "azimuth_angle", "AzimuthAngle"}),
      findFirstField(fields, {"elevation", "elevation_angle", "ElevationAngle"})};
  if (polar[0] == nullptr || polar[1] == nullptr) return cloud;
  for (const PointField* field : polar) {
    const std::string defect = field != nullptr ? defectOf(*field, view.point_step) : "";
    if (defect.empty()) continue;
    faults.push_back(defect);
    return cloud;
  }

  auto result = boost::make_shared<sensor_msgs::PointCloud2>();
  result->header = cloud->header;
  result->height = 1;
  result->width = static_cast<std::uint32_t>(view.size());
  result->fields = cloud->fields;
  for (const char* name : {"x", "y", "z"}) {
    result->fields.push_back(floatField(*cloud, name, cloud->point_step + result->point_step));
    result->point_step += sizeof(float);
  }
  result->point_step += cloud->point_step;
  result->row_step = result->point_step * result->width;
  result->is_bigendian = cloud->is_bigendian;
  result->is_dense = cloud->is_dense;
  result->data.resize(std::size_t{result->point_step} * result->width);

  const double radians = unit == AngleUnit::kDegrees ? M_PI / 180.0 : 1.0;
  std::size_t wide = 0;  // azimuths of more than a turn
  std::uint8_t* out = result->data.data();
  for (std::size_t i = 0; i < view.size(); ++i, out += result->point_step) {
    const std::uint8_t* point = view.point(i);
    const auto read = [point](const PointField& field) {
      return readScalar(point + field.offset, field.type);
    };
    const double range = read(*polar[0]);
    const double azimuth = radians * read(*polar[1]);
    const double elevation = polar[2] != nullptr ? radians * read(*polar[2]) : 0.0;
    if (std::abs(azimuth) > 2.0 * M_PI) ++wide;
    const float position[] = {static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
                              static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
                              static_cast<float>(range * std::sin(elevation))};
    std::memcpy(out, point, cloud->point_step);
    std::memcpy(out + cloud->point_step, position, sizeof position);
  }
  // A broken value is no sign of another unit.
  if (unit == AngleUnit::kRadians && 10 * wide > view.size()) {
    faults.push_back("field '" + polar[1]->name +
                     "' has angles of more than a turn: set angle_unit to degrees");
  }
  return result;
}

sensor_msgs::PointCloud2 labelledCloud(const sensor_msgs::PointCloud2& cloud, const PointCloudView& view,
                                       Span<const DopplerReturn> returns, const float* residuals,
                                       const ReturnLabel* labels, ReturnLabel wanted) {
  sensor_msgs::PointCloud2 result;
  result.header = cloud.header;
  result.height = 1;
  result.width = static_cast<std::uint32_t>(std::count(labels, labels + returns.size(), wanted));
  result.fields = cloud.fields;
  result.fields.push_back(floatField(cloud, "doppler", cloud.point_step));
  result.fields.push_back(floatField(cloud, "residual", cloud.point_step + sizeof(float)));
  result.is_bigendian = cloud.is_bigendian;
  result.is_dense = cloud.is_dense;
  result.point_step = cloud.point_step + 2 * sizeof(float);
  result.row_step = result.point_step * result.width;
  result.data.resize(result.row_step);

  std::uint8_t* out = result.data.data();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (labels[i] != wanted) continue;
    std::memcpy(out, view.point(returns[i].index), cloud.point_step);
    std::memcpy(out + cloud.point_step, &returns[i].doppler, sizeof(float));
    std::memcpy(out + cloud.point_step + sizeof(float), &residuals[i], sizeof(float));
    out += result.point_step;
  }
  return result;
}

sensor_msgs::PointCloud2Ptr keptCloud(const sensor_msgs::PointCloud2& cloud,
                                      const std::vector<std::uint8_t>& keep) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  auto result = boost::make_shared<sensor_msgs::PointCloud2>(cloud);
  if (view.size() == 0) return result;
  const auto place = [&](std::size_t i) { return result->data.data() + (view.point(i) - view.data); };
  if (cloud.height == 1) {
    std::uint8_t* out = result->data.data();
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (keep[i] == 0) continue;
      std::memcpy(out, view.point(i), cloud.point_step);
      out += cloud.point_step;
    }
    result->data.resize(static_cast<std::size_t>(out - result->data.data()));
    result->width = static_cast<std::uint32_t>(result->data.size() / cloud.point_step);
    result->row_step = static_cast<std::uint32_t>(result->data.size());
    return result;
  }
  for (const char* name : {"x", "y", "z"}) {
    const PointField* field = findField(fields, name);
    const bool is_double = field != nullptr && field->type == ScalarType::kFloat64;
    if (field == nullptr || (field->type != ScalarType::kFloat32 && !is_double))
      throw std::invalid_argument(std::string("its field ") + name +
                                  " is no float: an organised cloud needs it");
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (keep[i] != 0) continue;
      const double wide = std::numeric_limits<double>::quiet_NaN();
      const float narrow = std::numeric_limits<float>::quiet_NaN();
      std::memcpy(place(i) + field->offset, is_double ? static_cast<const void*>(&wide) : &narrow,
                  scalarSize(field->type));
      result->is_dense = 0;
    }
  }
  return result;
}

}  // namespace radar_dot
