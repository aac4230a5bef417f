// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

namespace radar_dot {

/// Mounts of sensors from TF. Asks the buffer each time, so that a new calibration is followed, and
/// never waits; the last good answer bridges the moment after a buffer was cleared.
class Extrinsics {
 public:
  /// @param base_frame  frame the mounts are given in
  /// @param handle      its callback queue is not used: TF is received in a thread of its own
  Extrinsics(std::string base_frame, const ros::NodeHandle& handle);

  /// T_base_from_sensor; none, and `error`, when TF knows no way between the two frames.
  std::optional<Eigen::Isometry3d> lookup(const std::string& sensor_frame, std::string& error);

  const std::string& baseFrame() const noexcept { return base_frame_; }
  tf2_ros::Buffer& buffer() noexcept { return buffer_; }

 private:
  std::string base_frame_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  std::map<std::string, Eigen::Isometry3d> last_;
};

/// The transform of a message.
Eigen::Isometry3d isometryOf(const geometry_msgs::Transform& transform);

}  // namespace radar_dot
