// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstring>
#include <string>
#include <vector>

namespace radar_dot::test {

/// One row of points with float32 fields. @param values  point by point, in the order of `names`
inline sensor_msgs::PointCloud2 floatCloud(const std::vector<std::string>& names,
                                           const std::vector<float>& values) {
  sensor_msgs::PointCloud2 cloud;
  for (const std::string& name : names) {
    sensor_msgs::PointField& field = cloud.fields.emplace_back();
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.point_step += 4;
  }
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(values.size() / names.size());
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(cloud.row_step);
  if (!values.empty()) std::memcpy(cloud.data.data(), values.data(), cloud.data.size());
  return cloud;
}

}  // namespace radar_dot::test
