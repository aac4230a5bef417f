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
  using Fault = std::function<void(sensor_msgs::PointCloud2&)>;

  explicit LiveRadars(ros::NodeHandle& handle);
  void set(std::size_t radar, const Fault& fault);  ///< until the next one
  void silence(std::size_t radar);                  ///< until set()
  void setAll(const Fault& fault);

 private:
  void publishNext();

  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::vector<ros::Publisher> publishers_;
  std::size_t next_ = 0;
  unsigned seed_ = 1;
  struct State {
    bool silent = false;
    Fault fault;
  };
  std::array<State, kRadars> states_;
  std::mutex mutex_;
  Ticker ticker_{13.0 * kRadars, [this] { publishNext(); }};
};

}  // namespace radar_dot::test
