// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/returns_over_ground.h"

#include <cmath>

#include "rotated_return.h"
#include "segmentation.h"

namespace radar_dot {

std::vector<ReturnOverGround> returnsOverGround(const RadarScan& scan, const Eigen::Vector3d& linear,
                                                const Eigen::Vector3d& angular,
                                                const OverGroundParams& params) {
  std::vector<ReturnOverGround> seen;
  const Eigen::Matrix3f R_base_from_sensor = scan.T_base_from_sensor.linear().cast<float>();
  const Eigen::Vector3d mount = scan.T_base_from_sensor.translation();
  const Eigen::Vector3d sensor_velocity = linear + angular.cross(mount);
  std::vector<float> velocities;
  std::vector<Eigen::Vector2f> positions;
  for (std::size_t i = 0; i < scan.returns.size(); ++i) {
    const DopplerReturn& measured = scan.returns[i];
    const RotatedReturn turned = rotatedReturn(measured, R_base_from_sensor, scan.bearing_rotation);
    const Eigen::Vector3d bearing = turned.bearing.cast<double>();
    ReturnOverGround over;
    over.time = scan.time;
    over.radar = scan.radar;
    over.index = i;
    over.sensor = mount.head<2>();
    over.position = positionOf(measured, scan.T_base_from_sensor).head<2>().cast<double>();
    over.velocity = static_cast<double>(turned.doppler) + bearing.dot(sensor_velocity);
    if (!over.position.allFinite() || !std::isfinite(over.velocity)) continue;
    const double across_speed = bearing.cross(sensor_velocity).z();
    const double across_variance = std::pow(params.noise.azimuth_std * across_speed, 2);
    over.variance = params.noise.doppler_std * params.noise.doppler_std + across_variance;
    const Eigen::Vector2d along = over.bearing();
    const Eigen::Vector2d across(-along.y(), along.x());
    const double across_std = params.noise.azimuth_std * static_cast<double>(measured.range);
    over.covariance = params.range_std * params.range_std * along * along.transpose() +
                      across_std * across_std * across * across.transpose();
    velocities.push_back(static_cast<float>(over.velocity));
    positions.emplace_back(over.position.cast<float>());
    seen.push_back(over);
  }
  std::vector<std::size_t> candidates;
  std::vector<ReturnLabel> labels;
  segmentReturns(params.segmentation, velocities, positions, candidates, labels);
  for (std::size_t k = 0; k < seen.size(); ++k)
    seen[k].label = scan.knownDynamic(seen[k].index) ? ReturnLabel::kDynamic : labels[k];
  return seen;
}

}  // namespace radar_dot
