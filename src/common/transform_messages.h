// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>

#include <Eigen/Geometry>
#include <string>

namespace radar_dot {

/// tf2 knows no leading slash; drivers from the days of tf still send it.
inline std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

/// The transform of a message; its quaternion need not be of unit length.
template <typename Translation>
Eigen::Isometry3d isometryOf(const Translation& t, const geometry_msgs::Quaternion& q) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() << t.x, t.y, t.z;
  return result;
}
inline Eigen::Isometry3d isometryOf(const geometry_msgs::Transform& transform) {
  return isometryOf(transform.translation, transform.rotation);
}
inline Eigen::Isometry3d isometryOf(const geometry_msgs::Pose& pose) {
  return isometryOf(pose.position, pose.orientation);
}

}  // namespace radar_dot
