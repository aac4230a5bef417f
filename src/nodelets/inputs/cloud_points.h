// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/extrinsics.h"
#include "radar_dot/vision/recent_scans.h"

namespace radar_dot {

/// The positions of all points of a cloud, finite or not, in its own frame. @throws as pointsOf()
std::vector<Eigen::Vector3f> positionsOf(const sensor_msgs::PointCloud2& cloud);

/// The finite points of a cloud, in its own frame, with the residual that radar/static and radar/dynamic have
/// (`ego_residual` or `residual`). @throws std::invalid_argument for sizes that contradict
/// each other, or a cloud without x, y and z.
std::vector<CloudPoint> pointsOf(const sensor_msgs::PointCloud2& cloud);

/// The latest clouds of any number of sensors, as points of the base frame.
class RecentClouds {
 public:
  /// @param warn  for sensors whose mount TF does not know
  RecentClouds(Extrinsics& extrinsics, EgoMotion& motion, std::function<void(const std::string&)> warn)
      : extrinsics_(extrinsics), motion_(motion), warn_(std::move(warn)) {}

  /// @throws std::invalid_argument as pointsOf()
  void add(const std::string& topic, const sensor_msgs::PointCloud2& cloud);
  void clear() { scans_.clear(); }

  /// RecentScans::at, with the mounts of TF and the motion of ego/twist.
  std::vector<CloudPoint> at(const ros::Time& time, double max_age, const GroundParams* ground = nullptr);
  /// The same without residuals, m.
  std::vector<Eigen::Vector3f> positionsAt(const ros::Time& time, double max_age,
                                           const GroundParams* ground = nullptr);

 private:
  Extrinsics& extrinsics_;
  EgoMotion& motion_;
  std::function<void(const std::string&)> warn_;
  RecentScans scans_;
};

}  // namespace radar_dot
