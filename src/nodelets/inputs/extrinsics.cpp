// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/extrinsics.h"

#include <tf2_ros/transform_listener.h>

#include <mutex>

#include "nodelets/common/process_clock.h"

namespace radar_dot {
namespace {

constexpr double kFarthest = 1e4;  // m, of a sensor from the origin of its vehicle

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
    if (!mount.matrix().allFinite() || mount.translation().norm() > kFarthest) {
      error = "the transform from '" + frame + "' to '" + base_frame_ + "' is no mount on a vehicle";
      return std::nullopt;
    }
    last_[frame] = mount;
    return mount;
  } catch (const tf2::TransformException& exception) {
    const auto known = last_.find(frame);
    if (known != last_.end()) return known->second;
    error = "no transform from '" + frame + "' to '" + base_frame_ + "': " + exception.what();
    return std::nullopt;
  }
}

std::optional<Eigen::Isometry3d> Extrinsics::lookupCamera(const std::string& image_frame,
                                                          std::string& error) {
  constexpr double kUp = 0.7, kDown = -0.95;  // cosines of 45 and, to the other side, 18 degrees
  std::optional<Eigen::Isometry3d> mount = lookup(image_frame, error);
  if (!mount) return mount;
  const double up = mount->linear()(2, 2);
  if (up < kUp && up > kDown) return mount;
  error = "the z axis of '" + withoutSlash(image_frame) + "' looks " + (up > 0.0 ? "up" : "down") +
          ": images need an optical frame, z ahead, x to the right, y down; the usual turn from the camera's "
          "body to it is static_transform_publisher 0 0 0 -1.5708 0 -1.5708 (yaw, pitch, roll)";
  return std::nullopt;
}

}  // namespace radar_dot
