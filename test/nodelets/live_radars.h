// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <array>
#include <functional>
#include <mutex>
#include <vector>

#include "live_graph.h"
#include "synthetic_bag.h"

namespace radar_dot::test {

/// Advertises the topics of the synthetic radars and sends their mounts.
std::vector<ros::Publisher> advertiseRadars(ros::NodeHandle& handle,
                                            tf2_ros::StaticTransformBroadcaster& broadcaster,
                                            const ros::Time& stamp);

/// Publishes the scans of five radars in a steady turn, each at 13 Hz and through its fault.
class LiveRadars {
 public:
  static constexpr double kSpeed = 8.0, kYawRate = 0.1;  ///< m/s, rad/s
  static constexpr std::size_t kRadars = 5;
  enum Radar : std::size_t { kFront, kFrontLeft, kFrontRight, kBackLeft, kBackRight };
  /// Returns false when the radar is to stay silent.
  using Fault = std::function<bool(sensor_msgs::PointCloud2&)>;
  static bool none(sensor_msgs::PointCloud2&) { return true; }
  static bool silent(sensor_msgs::PointCloud2&) { return false; }

  explicit LiveRadars(ros::NodeHandle& handle);
  void set(std::size_t radar, const Fault& fault);
  void setAll(const Fault& fault);

 private:
  void publishNext();

  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::vector<ros::Publisher> publishers_;
  std::size_t next_ = 0;
  unsigned seed_ = 1;
  std::array<Fault, kRadars> faults_{none, none, none, none, none};
  std::mutex mutex_;
  Ticker ticker_{13.0 * kRadars, [this] { publishNext(); }};
};

}  // namespace radar_dot::test
