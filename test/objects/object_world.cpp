// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "objects/object_world.h"

#include <cmath>

namespace radar_dot::test {

Eigen::Isometry3d ObjectWorld::poseAt(double time) const {
  const double turn = yaw_rate * time;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  if (yaw_rate == 0.0) {
    pose.translation().x() = speed * time;
  } else {
    pose.translation() = speed / yaw_rate * Eigen::Vector3d(std::sin(turn), 1.0 - std::cos(turn), 0.0);
  }
  return pose;
}

std::vector<ReturnOverGround> ObjectWorld::scan(std::size_t radar, double time) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const Eigen::Isometry2d base_from_world =
      Eigen::Isometry2d(Eigen::Translation2d(poseAt(time).translation().head<2>()) *
                        Eigen::Rotation2Dd(yaw_rate * time))
          .inverse();
  std::vector<ReturnOverGround> returns;
  const auto add = [&](const Eigen::Vector2d& from_sensor, double velocity) {
    const double range = from_sensor.norm() + range_std * normal(random);
    const double azimuth = std::atan2(from_sensor.y(), from_sensor.x()) + azimuth_std * normal(random);
    const Eigen::Vector2d along(std::cos(azimuth), std::sin(azimuth)), across(-along.y(), along.x());
    ReturnOverGround one;
    one.time = time;
    one.radar = radar;
    one.index = returns.size();
    one.sensor = radars[radar];
    one.position = radars[radar] + range * along;
    one.covariance = range_std * range_std * along * along.transpose() +
                     std::pow(azimuth_std * range, 2) * across * across.transpose();
    one.velocity = velocity + doppler_std * normal(random);
    one.variance = doppler_std * doppler_std;
    one.label = std::abs(one.velocity) > 0.8 ? ReturnLabel::kDynamic : ReturnLabel::kStatic;
    returns.push_back(one);
  };
  for (const Mover& mover : movers) {
    if (uniform(random) > detection) continue;
    const Eigen::Vector2d from_sensor = base_from_world * mover.at(time) - radars[radar];
    add(from_sensor, from_sensor.normalized().dot(base_from_world.linear() * mover.velocity));
  }
  std::poisson_distribution<int> count(clutter);
  for (int left = clutter > 0.0 ? count(random) : 0; left > 0; --left) {
    const double azimuth = 6.283 * uniform(random), range = 5.0 + 55.0 * uniform(random);
    add({range * std::cos(azimuth), range * std::sin(azimuth)}, -10.0 + 20.0 * uniform(random));
  }
  return returns;
}

void ObjectWorld::run(ObjectTracker& tracker, double begin, double end) {
  constexpr double kPeriod = 1.0 / 13.0;
  for (int k = 0;; ++k) {
    for (std::size_t radar = 0; radar < radars.size(); ++radar) {
      const double time = begin + kPeriod * (k + 0.17 * static_cast<double>(radar));
      if (time >= end) return;
      tracker.update(time, radar, detectObjects(time, scan(radar, time)), poseAt(time));
    }
  }
}

}  // namespace radar_dot::test
