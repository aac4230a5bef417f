// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "object_scene.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>
#include <cmath>

#include "float_cloud.h"
#include "live_radars.h"

namespace radar_dot::test {
namespace {

constexpr double kPeriod = 1.0 / 13.0;  // s
constexpr double kRate = 2.0;           // times real time
constexpr int kStill = 40;              // returns of static pixels, per scan
constexpr double kDopplerStd = 0.05;    // m/s
constexpr double kRangeStd = 0.1;       // m

Eigen::Isometry3d isometryOf(const geometry_msgs::TransformStamped& mount) {
  const auto& t = mount.transform.translation;
  const auto& q = mount.transform.rotation;
  return Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(q.w, q.x, q.y, q.z);
}

}  // namespace

ObjectScene::ObjectScene(ros::NodeHandle& handle)
    : clock_(handle.advertise<rosgraph_msgs::Clock>("/clock", 10)),
      publishers_(advertiseRadars(handle, broadcaster_, stampAt(0.0))),
      radars_(syntheticRadars()) {}

bool ObjectScene::heard() const {
  return std::all_of(publishers_.begin(), publishers_.end(),
                     [](const ros::Publisher& publisher) { return publisher.getNumSubscribers() > 0; });
}

Eigen::Vector2d ObjectScene::carPosition(double seconds) const {
  const Eigen::Vector2d in_world = car->at(seconds);
  return (world.poseAt(seconds).inverse() * Eigen::Vector3d(in_world.x(), in_world.y(), 0.0)).head<2>();
}

Eigen::Vector2d ObjectScene::carVelocity(double seconds) const {
  return Eigen::Rotation2Dd(-world.yaw_rate * seconds) * car->velocity;
}

sensor_msgs::PointCloud2 ObjectScene::scan(std::size_t radar, double seconds) {
  const Eigen::Isometry3d T_base_from_sensor = isometryOf(radars_[radar].mount);
  const Eigen::Vector3d mount = T_base_from_sensor.translation();
  const Eigen::Vector3d sensor_velocity(world.speed - world.yaw_rate * mount.y(), world.yaw_rate * mount.x(),
                                        0.0);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<float> values;
  const auto add = [&](const Eigen::Vector3d& in_sensor, const Eigen::Vector3d& velocity) {
    const Eigen::Vector3d bearing = (T_base_from_sensor.linear() * in_sensor).normalized();
    const double doppler = bearing.dot(velocity - sensor_velocity) + kDopplerStd * normal(random_);
    const Eigen::Vector3d measured = in_sensor + kRangeStd * normal(random_) * in_sensor.normalized();
    for (const double value : {measured.x(), measured.y(), measured.z(), doppler})
      values.push_back(static_cast<float>(value));
  };
  for (int i = 0; i < kStill; ++i) {
    const double azimuth = -1.0 + 2.0 * uniform(random_), range = 5.0 + 60.0 * uniform(random_);
    add({range * std::cos(azimuth), range * std::sin(azimuth), 0.0}, Eigen::Vector3d::Zero());
  }
  if (car) {
    const Eigen::Vector2d position = carPosition(seconds), velocity = carVelocity(seconds);
    for (const double along : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector3d in_base(position.x() + along, position.y(), mount.z());
      add(T_base_from_sensor.inverse() * in_base, {velocity.x(), velocity.y(), 0.0});
    }
  }

  sensor_msgs::PointCloud2 cloud = floatCloud({"x", "y", "z", "doppler"}, values);
  cloud.header.stamp = stampAt(seconds);
  cloud.header.frame_id = radars_[radar].name;
  return cloud;
}

void ObjectScene::drive(double begin, double end) {
  const double step = kPeriod / static_cast<double>(radars_.size());
  ros::WallRate pace(kRate / step);
  std::size_t radar = 0;
  for (double seconds = begin; seconds < end && ros::ok(); seconds += step) {
    rosgraph_msgs::Clock clock;
    clock.clock = stampAt(seconds);
    clock_.publish(clock);
    before_scan(seconds);
    publishers_[radar].publish(scan(radar, seconds));
    radar = (radar + 1) % radars_.size();
    pace.sleep();
  }
}

}  // namespace radar_dot::test
