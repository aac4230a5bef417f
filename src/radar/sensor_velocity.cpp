// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sensor_velocity.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "rotated_return.h"

namespace radar_dot {
namespace {

constexpr int kIterations = 4;
constexpr double kCauchyScale = 2.0;  // sigmas of a residual at which a return has half its weight
// 1/(m/s)^2: what is known of the velocity beforehand, so that narrow bearings leave it finite.
constexpr double kPriorInformation = 1e-3;

struct Constraint {
  Eigen::Vector2d bearing;
  double right_hand_side;  // m/s, -d
  double variance;         // (m/s)^2
};

std::optional<SensorVelocity> solve(const std::vector<Constraint>& constraints, const Eigen::Vector2d& start,
                                    double scan_std) {
  Eigen::Vector2d velocity = start;
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  Eigen::Vector2d common = Eigen::Vector2d::Zero();
  double chi_squared = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix2d information = kPriorInformation * Eigen::Matrix2d::Identity();
    Eigen::Vector2d right = kPriorInformation * start;
    common.setZero();
    chi_squared = 0.0;
    for (const Constraint& c : constraints) {
      const double error = c.bearing.dot(velocity) - c.right_hand_side;
      const double squared = error * error / c.variance;
      const double share = 1.0 / (1.0 + squared / (kCauchyScale * kCauchyScale));
      const double weight = share / c.variance;
      information += weight * c.bearing * c.bearing.transpose();
      right += weight * c.right_hand_side * c.bearing;
      common += weight * c.bearing;
      chi_squared += share * squared;
    }
    inverse = information.ldlt().solve(Eigen::Matrix2d::Identity());
    velocity = inverse * right;
  }
  const double freedom = std::max(1.0, static_cast<double>(constraints.size()) - 2.0);
  const Eigen::Vector2d shared = inverse * common;
  SensorVelocity result;
  result.velocity = velocity;
  result.covariance =
      std::max(1.0, chi_squared / freedom) * inverse + scan_std * scan_std * shared * shared.transpose();
  if (!result.velocity.allFinite() || !result.covariance.allFinite()) return std::nullopt;
  return result;
}

}  // namespace

std::vector<SensorVelocity> sensorVelocities(const std::vector<RadarScan>& scans,
                                             const EgoVelocityResult& result,
                                             const EgoVelocityParams& params) {
  std::vector<SensorVelocity> sensors;
  if (!result.valid()) return sensors;
  std::vector<Constraint> constraints;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const RadarScan& scan = scans[s];
    if (!scan.T_base_from_sensor.matrix().allFinite()) continue;
    const Eigen::Matrix3f R_base_from_sensor = scan.T_base_from_sensor.linear().cast<float>();
    const Eigen::Vector3d lever_arm = scan.T_base_from_sensor.translation();
    const Eigen::Vector3d velocity = result.linear + result.angular.cross(lever_arm);
    constraints.clear();
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      if (std::abs(static_cast<double>(result.residuals[result.offsets[s] + i])) >=
          params.segmentation.threshold)
        continue;
      if (scan.knownDynamic(i)) continue;
      const RotatedReturn seen = rotatedReturn(scan.returns[i], R_base_from_sensor, scan.bearing_rotation);
      const Eigen::Vector3d bearing = seen.bearing.cast<double>();
      if (!bearing.allFinite() || !std::isfinite(seen.doppler)) continue;
      const double tangential_speed = bearing.x() * velocity.y() - bearing.y() * velocity.x();
      constraints.push_back(
          {bearing.head<2>(), -static_cast<double>(seen.doppler) - bearing.z() * velocity.z(),
           params.noise.doppler_std * params.noise.doppler_std +
               params.noise.azimuth_std * params.noise.azimuth_std * tangential_speed * tangential_speed});
    }
    if (constraints.size() < static_cast<std::size_t>(params.sensor.min_sensor_returns)) continue;
    if (std::optional<SensorVelocity> sensor =
            solve(constraints, velocity.head<2>(), params.sensor.sensor_scan_std)) {
      sensor->radar = scan.radar;
      sensor->time = scan.time;
      sensor->lever_arm = lever_arm.head<2>();
      // Roll and pitch rates move a radar at a height, which the motion in the plane does not know.
      const Eigen::Vector3d rolling(result.angular.x(), result.angular.y(), 0.0);
      sensor->velocity -= rolling.cross(lever_arm).head<2>();
      sensors.push_back(*sensor);
    }
  }
  return sensors;
}

}  // namespace radar_dot
