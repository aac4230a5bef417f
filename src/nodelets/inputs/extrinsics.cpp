// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/extrinsics.h"

#include <tf2_ros/transform_listener.h>

#include <mutex>

#include "nodelets/common/process_clock.h"

namespace radar_dot {
namespace {

struct ReceivedTransforms {
  explicit ReceivedTransforms(const ros::NodeHandle& handle)
      : listener(buffer, handle, !ProcessClock::isRecorded()) {}
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener;
};

/// The buffer of all nodelets of the process that have the same names for the topics of TF, as long as one of
/// them has it.
std::shared_ptr<tf2_ros::Buffer> sharedBuffer(const ros::NodeHandle& handle) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, std::weak_ptr<ReceivedTransforms>> shared;
  const std::lock_guard<std::mutex> lock(mutex);
  std::weak_ptr<ReceivedTransforms>& known =
      shared[{handle.resolveName("/tf"), handle.resolveName("/tf_static")}];
  std::shared_ptr<ReceivedTransforms> received = known.lock();
  if (!received) known = received = std::make_shared<ReceivedTransforms>(handle);
  return {received, &received->buffer};
}

}  // namespace

geometry_msgs::Transform transformOf(const Eigen::Isometry3d& isometry) {
  const Eigen::Quaterniond rotation(isometry.linear());
  geometry_msgs::Transform transform;
  transform.translation.x = isometry.translation().x();
  transform.translation.y = isometry.translation().y();
  transform.translation.z = isometry.translation().z();
  transform.rotation.x = rotation.x();
  transform.rotation.y = rotation.y();
  transform.rotation.z = rotation.z();
  transform.rotation.w = rotation.w();
  return transform;
}

Extrinsics::Extrinsics(const std::string& base_frame, const ros::NodeHandle& handle)
    : base_frame_(withoutSlash(base_frame)), buffer_(sharedBuffer(handle)) {}

std::optional<Eigen::Isometry3d> Extrinsics::lookup(const std::string& sensor_frame, std::string& error) {
  const std::string frame = withoutSlash(sensor_frame);
  if (frame == base_frame_) return Eigen::Isometry3d::Identity();
  try {
    const Eigen::Isometry3d mount =
        isometryOf(buffer_->lookupTransform(base_frame_, frame, ros::Time(0)).transform);
    last_[frame] = mount;
    return mount;
  } catch (const tf2::TransformException& exception) {
    const auto known = last_.find(frame);
    if (known != last_.end()) return known->second;
    error = "no transform from '" + frame + "' to '" + base_frame_ + "': " + exception.what();
    return std::nullopt;
  }
}

}  // namespace radar_dot
