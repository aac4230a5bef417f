// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the example of the documentation, and reads a cloud of PCL as that of a radar.
#include EXAMPLE
#include <radar_dot/radar/doppler_returns.h>

#include <cstdio>

/// Two cars that come, one that drives away between them, and a return alone.
Cloud cars() {
  Cloud cloud;
  for (const auto& [x, y, residual] : {std::tuple{10.F, 0.F, -5.F},
                                       {11.F, 1.F, -5.F},
                                       {12.F, 0.F, -5.F},
                                       {13.F, 0.F, 5.F},
                                       {15.F, 0.F, -3.F},
                                       {16.F, 0.F, -3.F},
                                       {50.F, 9.F, -4.F}}) {
    radar_dot::RadarPoint point;
    point.x = x;
    point.y = y;
    point.doppler = residual - 10.F;
    point.residual = residual;
    cloud.push_back(point);
  }
  return cloud;
}

int main() {
  sensor_msgs::PointCloud2 message;
  pcl::toROSMsg(cars(), message);
  const Cloud::Ptr nearing(new Cloud);
  const std::vector<pcl::PointIndices> clusters = approaching(message, nearing);
  for (const pcl::PointIndices& cluster : clusters)
    std::printf("%zu returns, the first at %g m\n", cluster.indices.size(), (*nearing)[cluster.indices[0]].x);

  std::vector<radar_dot::PointField> fields;
  for (const sensor_msgs::PointField& field : message.fields)
    fields.push_back(
        {field.name, field.offset, static_cast<radar_dot::ScalarType>(field.datatype), field.count});
  radar_dot::DopplerExtractor extractor;
  std::vector<radar_dot::DopplerReturn> returns;
  extractor.extract({&fields, message.data.data(), message.point_step, message.width}, returns);
  std::printf("%zu returns read from %s\n", returns.size(), extractor.dopplerSource().c_str());
  return clusters.size() == 2 && clusters[0].indices.size() == 3 && clusters[1].indices.size() == 2 &&
                 returns.size() == cars().size()
             ? 0
             : 1;
}
