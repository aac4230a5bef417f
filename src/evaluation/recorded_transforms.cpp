// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/recorded_transforms.h"

#include <fmt/format.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include "config/mounts_file.h"
#include "nodelets/inputs/extrinsics.h"

namespace radar_dot::evaluation {

void Transforms::add(const rosbag::MessageInstance& message) {
  const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
  if (!transforms) return;
  for (const geometry_msgs::TransformStamped& transform : transforms->transforms)
    if (given_.count(withoutSlash(transform.child_frame_id)) == 0)
      add(transform, message.getTopic() == "/tf_static");
}

void Transforms::addFile(const std::string& path) {
  for (const Mount& mount : readMounts(path)) {
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = mount.parent;
    transform.child_frame_id = mount.child;
    transform.transform = transformOf(mount.isometry());
    add(transform, true);
    given_.insert(withoutSlash(mount.child));
  }
}

void Transforms::add(geometry_msgs::TransformStamped transform, bool is_static) {
  transform.header.frame_id = withoutSlash(transform.header.frame_id);
  transform.child_frame_id = withoutSlash(transform.child_frame_id);
  if (transform.child_frame_id.empty() || transform.header.frame_id.empty()) return;
  buffer_.setTransform(transform, "bag", is_static);
  parents_[transform.child_frame_id] = transform.header.frame_id;
  if (!is_static) stamps_[transform.child_frame_id].push_back(transform.header.stamp);
}

std::optional<Eigen::Isometry3d> Transforms::between(const std::string& to, const std::string& from,
                                                     const ros::Time& time) const {
  try {
    return isometryOf(buffer_.lookupTransform(to, from, time).transform);
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

void Transforms::addPoses(const std::string& fixed, const std::string& frame, RecordedMotion& motion) const {
  std::string moving = frame;
  for (std::size_t i = 0; i < parents_.size() && stamps_.count(moving) == 0; ++i) {
    const auto parent = parents_.find(moving);
    if (parent == parents_.end()) break;
    moving = parent->second;
  }
  const auto stamps = stamps_.find(moving);
  if (stamps == stamps_.end()) return;
  for (const ros::Time& stamp : stamps->second) {
    ++motion.counts.messages;
    if (const auto T = between(fixed, frame, stamp)) motion.poses.emplace_back(stamp.toSec(), *T);
  }
}

std::string Transforms::missing(const std::string& to, const std::string& from) const {
  return fmt::format(
      "no transform from '{}' to '{}' in the recording: give it by --tf FILE; the transforms are: {}", from,
      to, text());
}

std::string Transforms::text() const {
  std::string text;
  for (const auto& [child, parent] : parents_)
    text += fmt::format("{}{} -> {}", text.empty() ? "" : ", ", parent, child);
  return text.empty() ? "none" : text;
}

}  // namespace radar_dot::evaluation
