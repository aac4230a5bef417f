// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <rosbag/message_instance.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "radar_dot/evaluation/motion_comparison.h"

namespace radar_dot::evaluation {

/// The transforms of a recording.
class Transforms {
 public:
  /// Of /tf or /tf_static.
  void add(const rosbag::MessageInstance& message);
  /// Those of a file for `--tf`: a YAML list of {parent: base_link, child: radar, x: 3.5, y: 0, z: 0.5, roll:
  /// 0, pitch: 0, yaw: 0}, m and rad. They take the place of those of the recording that come later.
  /// @throws ConfigFileError
  void addFile(const std::string& path);

  /// None where the tree does not join them.
  std::optional<Eigen::Isometry3d> between(const std::string& to, const std::string& from,
                                           const ros::Time& time = ros::Time(0)) const;
  /// Poses of a frame at the stamps of the transform that moves it.
  void addPoses(const std::string& fixed, const std::string& frame, RecordedMotion& motion) const;
  /// That there is no such transform, and what cures it.
  std::string missing(const std::string& to, const std::string& from) const;
  /// "map -> base_link, base_link -> radar", or "none".
  std::string text() const;

 private:
  void add(geometry_msgs::TransformStamped transform, bool is_static);

  tf2::BufferCore buffer_{ros::Duration(1e8)};
  std::set<std::string> given_;  ///< children of the file
  std::map<std::string, std::string> parents_;
  std::map<std::string, std::vector<ros::Time>> stamps_;  ///< by child
};

}  // namespace radar_dot::evaluation
