// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The one header that needs PCL; no library of this package does for it. PCL has its algorithms compiled for
// its own types alone: define PCL_NO_PRECOMPILE before the first header of PCL to use them with this one.
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace radar_dot {

/// A return of radar/static or radar/dynamic, in the frame of its radar, for pcl::PointCloud.
/// pcl::fromROSMsg() takes the fields of the same names, float32; of `doppler` and `residual` those that
/// EgoVelocity added, which are called ego_doppler and ego_residual where the radar has fields of that name.
/// A cloud may lack z and rcs, or have an rcs of another type. Where one of the others is missing PCL warns.
struct EIGEN_ALIGN16 RadarPoint {
  PCL_ADD_POINT4D  ///< x, y, z: m; z is 0 where the cloud has none
      float doppler = std::numeric_limits<float>::quiet_NaN();  ///< m/s, range rate as EgoVelocity used it
  float residual = std::numeric_limits<float>::quiet_NaN();     ///< m/s, positive = recedes
  float rcs = std::numeric_limits<float>::quiet_NaN();  ///< dBsm; NaN where the cloud has none in float32

  RadarPoint() : data{0.0F, 0.0F, 0.0F, 1.0F} {}
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace radar_dot

POINT_CLOUD_REGISTER_POINT_STRUCT(radar_dot::RadarPoint,                                            //
                                  (float, x, x)(float, y, y)(float, z, z)(float, doppler, doppler)  //
                                  (float, residual, residual)(float, rcs, rcs))

namespace pcl {

/// Which bytes of a message are which of a point; in place of PCL's own, which warns of all that is missing.
template <>
inline void createMapping<radar_dot::RadarPoint>(const std::vector<PCLPointField>& msg_fields,
                                                 MsgFieldMap& field_map) {
  std::vector<PCLPointField> wanted;
  for_each_type<traits::fieldList<radar_dot::RadarPoint>::type>(
      detail::FieldAdder<radar_dot::RadarPoint>(wanted));
  for (const PCLPointField& field : wanted) {
    const auto named = [&msg_fields](const std::string& name) {
      return std::find_if(msg_fields.begin(), msg_fields.end(),
                          [&name](const PCLPointField& given) { return given.name == name; });
    };
    auto given = named("ego_" + field.name);
    if (given == msg_fields.end()) given = named(field.name);
    if (given != msg_fields.end() && given->datatype == field.datatype && given->count <= 1) {
      field_map.emplace_back();
      field_map.back().serialized_offset = given->offset;
      field_map.back().struct_offset = field.offset;
      field_map.back().size = sizeof(float);
    } else if (field.name != "rcs" && (field.name != "z" || given != msg_fields.end())) {
      PCL_WARN("radar_dot::RadarPoint: the cloud has no field '%s' of type float32.\n", field.name.c_str());
    }
  }
}

}  // namespace pcl
