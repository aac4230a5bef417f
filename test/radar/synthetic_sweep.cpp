// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_sweep.h"

#include <cmath>
#include <random>

namespace radar_dot::test {

std::vector<RadarScan> Sweep::scans() const {
  std::vector<RadarScan> result;
  for (std::size_t i = 0; i < returns.size(); ++i) result.push_back({returns[i], mounts[i], times[i], i});
  return result;
}

Eigen::Isometry3d mount(double x, double y, double z, double yaw, double pitch) {
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  T_base_from_sensor.translation() = Eigen::Vector3d(x, y, z);
  T_base_from_sensor.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  return T_base_from_sensor;
}

std::vector<Eigen::Isometry3d> carMounts() {
  return {mount(3.4, 0.0, 0.5, 0.0), mount(2.4, 0.8, 0.8, 1.54), mount(2.4, -0.8, 0.8, -1.57),
          mount(-0.56, 0.63, 0.5, 3.04), mount(-0.56, -0.62, 0.5, -3.07)};
}

Sweep makeSweep(const std::vector<Eigen::Isometry3d>& mounts, const Eigen::Vector3d& v,
                const Eigen::Vector3d& w, const SweepOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto direction = [](double azimuth, double elevation) {
    return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation));
  };
  Sweep sweep;
  sweep.mounts = mounts;
  for (const Eigen::Isometry3d& T_base_from_sensor : mounts) {
    std::vector<DopplerReturn> scan;
    std::vector<bool> moving;
    const Eigen::Vector3d sensor_velocity = v + w.cross(T_base_from_sensor.translation());
    for (std::size_t i = 0; i < options.returns_per_radar; ++i) {
      const double azimuth = (2.0 * unit(random) - 1.0) * options.half_field_of_view;
      const double elevation = (2.0 * unit(random) - 1.0) * options.max_elevation;
      const Eigen::Vector3d u_base = T_base_from_sensor.linear() * direction(azimuth, elevation);
      double doppler = -u_base.dot(sensor_velocity) + options.doppler_sigma * normal(random);
      const bool moves = unit(random) < options.moving_share;
      if (moves) {
        const double speed =
            options.min_target_speed + unit(random) * (options.max_target_speed - options.min_target_speed);
        doppler += unit(random) < 0.5 ? speed : -speed;
      }
      DopplerReturn measured;
      measured.bearing = direction(azimuth + options.azimuth_sigma * normal(random),
                                   elevation + options.elevation_sigma * normal(random))
                             .cast<float>();
      measured.range = static_cast<float>(2.0 + 78.0 * unit(random));
      measured.doppler = static_cast<float>(doppler);
      measured.index = static_cast<std::uint32_t>(i);
      scan.push_back(measured);
      moving.push_back(moves);
    }
    sweep.returns.push_back(std::move(scan));
    sweep.moving.push_back(std::move(moving));
    sweep.times.push_back(0.0);
  }
  return sweep;
}

}  // namespace radar_dot::test
