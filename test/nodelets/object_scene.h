// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "objects/object_world.h"
#include "synthetic_bag.h"

namespace radar_dot::test {

/// A vehicle that drives an arc among things that stand, with five radars and one car in view. Time is its
/// own: it sends /clock.
class ObjectScene {
 public:
  static constexpr double kStart = 1'600'000'000.0;  ///< s, stamp of its beginning

  explicit ObjectScene(ros::NodeHandle& handle);

  ObjectWorld world;         ///< for the pose of the vehicle
  std::optional<Mover> car;  ///< m and m/s, world frame, at s since the beginning
  /// Called before each scan, at s since the beginning.
  std::function<void(double)> before_scan = [](double) {};

  static ros::Time stampAt(double seconds) { return ros::Time(kStart + seconds); }
  /// Whether every scan has a subscriber.
  bool heard() const;
  /// Of the car, base frame at `seconds`.
  Eigen::Vector2d carPosition(double seconds) const;
  Eigen::Vector2d carVelocity(double seconds) const;  ///< over ground, axes of the base frame
  /// Sends the scans from `begin` to `end` (s since the beginning), twice as quick as real time.
  void drive(double begin, double end);

 private:
  sensor_msgs::PointCloud2 scan(std::size_t radar, double seconds);

  ros::Publisher clock_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::vector<ros::Publisher> publishers_;
  std::vector<SyntheticRadar> radars_;
  std::mt19937 random_{1};
};

}  // namespace radar_dot::test
