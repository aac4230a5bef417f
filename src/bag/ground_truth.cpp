// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/ground_truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <opencv2/imgcodecs.hpp>

#include "radar_dot/bag/messages.h"

namespace radar_dot::bag {
namespace {

using dataset::Index;
using dataset::Tables;

// A keyframe comes every 0.5 s; a little more keeps the boxes from flickering.
constexpr double kBoxLifetime = 0.6;  // s

/// A pose relative to the first of the scene, whose map coordinates are large.
struct TimedPose {
  double time = 0.0;  // s
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
};

std::vector<TimedPose> timedPoses(const Tables& tables, const std::vector<Index>& poses) {
  std::vector<TimedPose> timed;
  timed.reserve(poses.size());
  if (poses.empty()) return timed;
  const dataset::EgoPose& first = at(tables.ego_poses, poses.front());
  const Eigen::Vector3d origin = first.T_map_from_base().translation();
  for (const Index index : poses) {
    const dataset::EgoPose& pose = at(tables.ego_poses, index);
    const Eigen::Isometry3d T = pose.T_map_from_base();
    timed.push_back({1e-6 * static_cast<double>(pose.timestamp_us - first.timestamp_us),
                     T.translation() - origin, Eigen::Quaterniond(T.linear())});
  }
  return timed;
}

/// The pose at a time, held constant beyond the ends.
TimedPose interpolate(const std::vector<TimedPose>& poses, double time) {
  if (time <= poses.front().time) return poses.front();
  if (time >= poses.back().time) return poses.back();
  const auto after = std::upper_bound(poses.begin(), poses.end(), time,
                                      [](double t, const TimedPose& pose) { return t < pose.time; });
  const auto before = std::prev(after);
  const double share = (time - before->time) / (after->time - before->time);
  return {time, before->position + share * (after->position - before->position),
          before->rotation.slerp(share, after->rotation)};
}

BaseTwist differentiate(const TimedPose& from, const TimedPose& now, const TimedPose& to) {
  const double duration = to.time - from.time;
  if (!(duration > 0.0)) return {};
  const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
  BaseTwist twist;
  twist.linear = now.rotation.conjugate() * ((to.position - from.position) / duration);
  twist.angular = turn.axis() * (turn.angle() / duration);
  return twist;
}

bool moves(const Tables& tables, const dataset::SampleAnnotation& annotation) {
  return std::any_of(annotation.attributes.begin(), annotation.attributes.end(), [&tables](Index index) {
    return dataset::isMovingAttribute(at(tables.attributes, index).name);
  });
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

std::vector<BaseTwist> egoTwists(const Tables& tables, const std::vector<Index>& poses, double half_window) {
  const std::vector<TimedPose> timed = timedPoses(tables, poses);
  std::vector<BaseTwist> twists;
  twists.reserve(timed.size());
  for (const TimedPose& now : timed) {
    twists.push_back(differentiate(interpolate(timed, now.time - half_window), now,
                                   interpolate(timed, now.time + half_window)));
  }
  return twists;
}

nav_msgs::Odometry toOdometry(const dataset::EgoPose& pose, const BaseTwist& twist) {
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
    const bool moving = moves(tables, annotation);
    box.color.r = moving ? 0.9F : 0.1F;
    box.color.g = 0.3F;
    box.color.b = moving ? 0.1F : 0.9F;
    box.color.a = 0.5F;
    box.lifetime = ros::Duration(kBoxLifetime);
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
