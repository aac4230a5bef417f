// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "live_radars.h"

namespace radar_dot::test {

std::vector<ros::Publisher> advertiseRadars(ros::NodeHandle& handle,
                                            tf2_ros::StaticTransformBroadcaster& broadcaster,
                                            const ros::Time& stamp) {
  std::vector<ros::Publisher> publishers;
  std::vector<geometry_msgs::TransformStamped> mounts;
  for (const SyntheticRadar& radar : syntheticRadars()) {
    publishers.push_back(handle.advertise<sensor_msgs::PointCloud2>(radar.name, 10));
    mounts.push_back(radar.mount);
    mounts.back().header.stamp = stamp;
  }
  broadcaster.sendTransform(mounts);
  return publishers;
}

LiveRadars::LiveRadars(ros::NodeHandle& handle)
    : publishers_(advertiseRadars(handle, broadcaster_, ros::Time::now())) {}

void LiveRadars::set(std::size_t radar, const Fault& fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  states_.at(radar) = {false, fault};
}

void LiveRadars::silence(std::size_t radar) {
  const std::lock_guard<std::mutex> lock(mutex_);
  states_.at(radar).silent = true;
}

void LiveRadars::setAll(const Fault& fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  states_.fill({false, fault});
}

void LiveRadars::publishNext() {
  TrueState truth;
  truth.speed = kSpeed;
  truth.yaw_rate = kYawRate;
  sensor_msgs::PointCloud2 scan = syntheticScan(truth, next_, ros::Time::now(), seed_++);
  const std::lock_guard<std::mutex> lock(mutex_);
  const State& state = states_.at(next_);
  if (state.fault) state.fault(scan);
  if (!state.silent) publishers_[next_].publish(scan);
  next_ = (next_ + 1) % kRadars;
}

}  // namespace radar_dot::test
