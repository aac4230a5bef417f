// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/buffer.h>

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/transform_messages.h"

namespace radar_dot {

/// Mounts of sensors from TF, for as long as the process runs: asks for the latest transform each time, so
/// that a new calibration is followed, and never waits. The last good answer holds where there is no other,
/// as in the moment after a buffer was cleared. One listener serves all nodelets of the process.
class Extrinsics {
 public:
  /// @param base_frame  frame the mounts are given in
  /// @param handle      for the names of /tf and /tf_static; its callback queue is not used, except in a
  ///                    recording: TF is received in a thread of its own
  Extrinsics(const std::string& base_frame, const ros::NodeHandle& handle);

  /// T_base_from_sensor; none, and `error`, when TF knows no way between the two frames.
  std::optional<Eigen::Isometry3d> lookup(const std::string& sensor_frame, std::string& error);

  /// The same of the frame of an image, which has z ahead, x to the right and y down: none where z looks up,
  /// or straight down, as in a frame of the camera's body.
  std::optional<Eigen::Isometry3d> lookupCamera(const std::string& image_frame, std::string& error);

  const std::string& baseFrame() const noexcept { return base_frame_; }
  /// Safe to use from any thread.
  tf2_ros::Buffer& buffer() noexcept { return *buffer_; }

 private:
  std::string base_frame_;
  std::shared_ptr<tf2_ros::Buffer> buffer_;  // owns its listener
  std::map<std::string, Eigen::Isometry3d> last_;
};

geometry_msgs::Transform transformOf(const Eigen::Isometry3d& isometry);

}  // namespace radar_dot
