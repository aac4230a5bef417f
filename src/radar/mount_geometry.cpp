// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/mount_geometry.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace radar_dot {
namespace {

constexpr int kBearings = 25;  // of a radar
// 1 sigma of the yaw rate above which it is of no use: 0.05 rad/s are 60 degrees in 20 s.
constexpr double kPoor = 0.05;          // rad/s
constexpr double kMuchBetter = 2.0;     // what another model must gain to be advised
constexpr double kUndetermined = 10.0;  // m/s or rad/s

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Information on [vx, vy, w]. Errors of returns of one scan: independent ones, and one they share.
Eigen::Matrix3d informationOf(const std::vector<Eigen::Isometry3d>& T_base_from_sensor,
                              const EgoVelocityParams& params, double half_field_of_view) {
  const double weight = 1.0 / (params.noise.doppler_std * params.noise.doppler_std);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Eigen::Isometry3d& mount : T_base_from_sensor) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < kBearings; ++i) {
      const double azimuth = half_field_of_view * (2.0 * i / (kBearings - 1) - 1.0);
      const Eigen::Vector3d u = mount.linear() * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0);
      const Eigen::Vector3d row(u.x(), u.y(),
                                u.y() * mount.translation().x() - u.x() * mount.translation().y());
      information += weight * row * row.transpose();
      sum += weight * row;
    }
    const double shared = params.scan_std * params.scan_std;
    information -= shared / (1.0 + shared * weight * kBearings) * sum * sum.transpose();
  }
  return information;
}

/// 1 sigma of [vx, vy, w] under a model; infinite where it does not tell.
Eigen::Vector3d deviations(Eigen::Matrix3d information, MotionModel model, double sideslip_std) {
  const double known = 1e12;
  if (model == MotionModel::kAckermann) information(1, 1) += 1.0 / (sideslip_std * sideslip_std);
  const bool turns = model == MotionModel::kAckermann || model == MotionModel::kPlanarYaw;
  if (!turns) information(2, 2) += known;
  information.diagonal().array() += 1.0 / (kUndetermined * kUndetermined * 100.0);
  Eigen::Vector3d result = information.ldlt().solve(Eigen::Matrix3d::Identity()).diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < 3; ++i)
    if (!(result[i] < kUndetermined)) result[i] = kInfinite;
  if (!turns) result[2] = kInfinite;
  return result;
}

std::string reasonOf(const std::vector<Eigen::Isometry3d>& mounts) {
  if (mounts.size() == 1) return "there is one radar";
  double apart = 0.0;
  for (const Eigen::Isometry3d& a : mounts)
    for (const Eigen::Isometry3d& b : mounts)
      apart = std::max(apart, (a.translation() - b.translation()).head<2>().norm());
  return fmt::format("all radars sit within {:.1f} m of one another", apart);
}

}  // namespace

MountGeometry assessMounts(const std::vector<Eigen::Isometry3d>& T_base_from_sensor,
                           const EgoVelocityParams& params, double half_field_of_view) {
  const Eigen::Matrix3d information = informationOf(T_base_from_sensor, params, half_field_of_view);
  const auto stdOf = [&](MotionModel model) { return deviations(information, model, params.sideslip_std); };
  const Eigen::Vector3d std = stdOf(params.model);
  MountGeometry geometry{std[0], std[1], std[2], {}};
  const bool with_slip = params.model == MotionModel::kPlanarYaw;
  if (T_base_from_sensor.empty() || (!with_slip && params.model != MotionModel::kAckermann) ||
      !(geometry.yaw_rate_std > kPoor))
    return geometry;

  const MotionModel other = with_slip ? MotionModel::kAckermann : MotionModel::kPlanarYaw;
  const double other_std = stdOf(other)[2];
  const std::string uncertain = std::isinf(geometry.yaw_rate_std)
                                    ? std::string("at all")
                                    : fmt::format("better than to {:.2f} rad/s", geometry.yaw_rate_std);
  geometry.advice =
      fmt::format("{}: {} cannot tell the yaw rate{} {}: ", reasonOf(T_base_from_sensor),
                  std::string(toString(params.model)), with_slip ? " from sideslip" : "", uncertain);
  if (other_std * kMuchBetter < geometry.yaw_rate_std) {
    geometry.advice += fmt::format("model: {} ({:.2f} rad/s{})", std::string(toString(other)), other_std,
                                   with_slip ? ", base frame at the rear axle" : "");
  } else {
    geometry.advice +=
        "take it from an IMU or from odometry (rotation_source), or mount the radars farther "
        "from the rear axle";
  }
  return geometry;
}

}  // namespace radar_dot
