// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/ground_truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "radar_dot/bag/messages.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/common/stamps.h"

namespace radar_dot::bag {
namespace {

using dataset::Index;
using dataset::Tables;

// A keyframe comes every 0.5 s; a little more keeps the boxes from flickering.
constexpr double kBoxLifetime = 0.6;  // s

/// The poses, relative to the first of the scene, whose map coordinates and stamps are large.
std::vector<StampedPose> relativePoses(const Tables& tables, const std::vector<Index>& poses) {
  std::vector<StampedPose> relative;
  relative.reserve(poses.size());
  for (const Index index : poses) {
    const dataset::EgoPose& pose = at(tables.ego_poses, index);
    const dataset::EgoPose& first = at(tables.ego_poses, poses.front());
    relative.emplace_back(secondsOf(pose.timestamp_us - first.timestamp_us), pose.T_map_from_base());
    relative.back().position -= first.T_map_from_base().translation();
  }
  return relative;
}

visualization_msgs::Marker emptyMarker(const ros::Time& stamp) {
  visualization_msgs::Marker marker;
  marker.header.stamp = stamp;
  marker.header.frame_id = kMapFrame;
  marker.ns = "boxes";
  marker.pose.orientation.w = 1.0;
  return marker;
}

}  // namespace

std::vector<StampedTwist> egoTwists(const Tables& tables, const std::vector<Index>& poses,
                                    double half_window) {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  const std::vector<StampedPose> relative = relativePoses(tables, poses);
  PoseBuffer track(kNoLimit, relative.size(), kNoLimit);
  for (const StampedPose& pose : relative) track.add(pose);
  const auto heldAt = [&](double time) {
    return *track.at(std::clamp(time, relative.front().time, relative.back().time));
  };
  std::vector<StampedTwist> twists(relative.size());
  for (std::size_t i = 0; i < relative.size(); ++i) {
    const StampedPose from = heldAt(relative[i].time - half_window);
    const StampedPose to = heldAt(relative[i].time + half_window);
    const double duration = to.time - from.time;
    twists[i].time = secondsOf(at(tables.ego_poses, poses[i]).timestamp_us);
    if (!(duration > 0.0)) continue;
    const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
    twists[i].linear = relative[i].rotation.conjugate() * ((to.position - from.position) / duration);
    twists[i].angular = turn.axis() * (turn.angle() / duration);
  }
  return twists;
}

nav_msgs::Odometry toOdometry(const dataset::EgoPose& pose, const StampedTwist& twist) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = toTime(pose.timestamp_us);
  odometry.header.frame_id = kMapFrame;
  odometry.child_frame_id = kBaseFrame;
  odometry.pose.pose = toPose(pose.T_map_from_base());
  odometry.twist.twist.linear.x = twist.linear.x();
  odometry.twist.twist.linear.y = twist.linear.y();
  odometry.twist.twist.linear.z = twist.linear.z();
  odometry.twist.twist.angular.x = twist.angular.x();
  odometry.twist.twist.angular.y = twist.angular.y();
  odometry.twist.twist.angular.z = twist.angular.z();
  return odometry;
}

visualization_msgs::MarkerArray toBoxes(const Tables& tables, Index sample) {
  const ros::Time stamp = toTime(at(tables.samples, sample).timestamp_us);
  visualization_msgs::MarkerArray boxes;
  boxes.markers.push_back(emptyMarker(stamp));
  boxes.markers.back().action = visualization_msgs::Marker::DELETEALL;
  for (const Index index : tables.annotationsOf(sample)) {
    const dataset::SampleAnnotation& annotation = at(tables.annotations, index);
    visualization_msgs::Marker box = emptyMarker(stamp);
    box.id = annotation.instance;
    box.type = visualization_msgs::Marker::CUBE;
    box.action = visualization_msgs::Marker::ADD;
    box.pose = toPose(annotation.T_map_from_box());
    box.scale.x = annotation.size[1];
    box.scale.y = annotation.size[0];
    box.scale.z = annotation.size[2];
    const bool moving = isMoving(tables, annotation);
    box.color.r = moving ? 0.9F : 0.1F;
    box.color.g = 0.3F;
    box.color.b = moving ? 0.1F : 0.9F;
    box.color.a = 0.5F;
    box.lifetime = ros::Duration(kBoxLifetime);
    box.text = at(tables.categories, at(tables.instances, annotation.instance).category).name;
    boxes.markers.push_back(box);
  }
  return boxes;
}

sensor_msgs::CompressedImage toDynamicMask(const Tables& tables,
                                           const std::vector<const dataset::InstanceMask*>& instances,
                                           const std::string& frame, const ros::Time& stamp) {
  sensor_msgs::CompressedImage message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.format = "png";
  std::vector<std::uint8_t> png;
  cv::imencode(".png", dataset::dynamicMask(tables, instances), png);
  message.data.assign(png.begin(), png.end());
  return message;
}

}  // namespace radar_dot::bag
