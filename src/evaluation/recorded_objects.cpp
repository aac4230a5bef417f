// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_objects.h"

#include <fmt/format.h>
#include <sensor_msgs/PointCloud2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>

#include "common/transform_messages.h"
#include "nodelets/inputs/cloud_points.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kMaxApart = 0.25;  // s, in which boxes move at constant velocity

Eigen::Matrix2d matrixOf(const boost::array<double, 4>& values) {
  return Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(values.data());
}

std::vector<ReportedTrack> tracksOf(const MovingObjects& message) {
  std::vector<ReportedTrack> tracks;
  for (const MovingObject& object : message.objects)
    tracks.push_back({object.id,
                      {object.position.x, object.position.y, object.position.z},
                      {object.velocity.x, object.velocity.y},
                      matrixOf(object.velocity_covariance)});
  return tracks;
}

}  // namespace

void RecordedObjects::add(const rosbag::MessageInstance& message) {
  const auto found = std::find(topics_.begin(), topics_.end(), message.getTopic());
  if (found == topics_.end()) return;
  const auto number = found - topics_.begin();
  if (number > 1) try {
      return addReturns(*message.instantiate<sensor_msgs::PointCloud2>(), number == 3);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(*found + ": " + error.what());
    }
  if (number == 1) return addBoxes(*message.instantiate<visualization_msgs::MarkerArray>());
  const MovingObjectsConstPtr objects = message.instantiate<MovingObjects>();
  if (!objects)
    throw std::runtime_error(*found + " has messages of another version of radar_dot/MovingObjects");
  objects_.emplace(objects->header.stamp, *objects);
}

void RecordedObjects::addBoxes(const visualization_msgs::MarkerArray& boxes) {
  for (const visualization_msgs::Marker& marker : boxes.markers) {
    std::vector<AnnotatedObject>& objects = keyframes_[marker.header.stamp];
    frame_ = withoutSlash(marker.header.frame_id);
    const auto isSame = [&marker](const AnnotatedObject& other) { return other.instance == marker.id; };
    if (marker.type != visualization_msgs::Marker::CUBE || marker.action != visualization_msgs::Marker::ADD ||
        std::any_of(objects.begin(), objects.end(), isSame))
      continue;
    AnnotatedObject& object = objects.emplace_back();
    const Eigen::Isometry3d T_map_from_box = isometryOf(marker.pose);
    object.box.time = marker.header.stamp.toSec();
    object.box.centre = T_map_from_box.translation();
    object.box.R_box_from_map = T_map_from_box.linear().topLeftCorner<2, 2>().transpose();
    object.box.half_size = 0.5 * Eigen::Vector2d(marker.scale.x, marker.scale.y);
    object.instance = marker.id;
    object.kind = kindOf(marker.text);
    object.state = marker.color.r > marker.color.b ? BoxState::kMoves : BoxState::kStands;
  }
}

void RecordedObjects::addReturns(const sensor_msgs::PointCloud2& cloud, bool dynamic) {
  Scan& scan = scans_[{cloud.header.stamp, withoutSlash(cloud.header.frame_id)}];
  for (const CloudPoint& point : pointsOf(cloud)) {
    if (!std::isfinite(point.residual)) continue;
    DopplerReturn one;
    one.range = point.position.norm();
    if (!(one.range > 0.F)) continue;
    one.bearing = point.position / one.range;
    one.doppler = point.residual;
    scan.returns.push_back(one);
    scan.is_dynamic.push_back(dynamic ? 1 : 0);
  }
}

/// Velocities along the tracks, by central difference, and what follows from them.
void RecordedObjects::completeBoxes(double min_speed) {
  std::map<dataset::Index, std::vector<AnnotatedObject*>> tracks;
  for (auto& [stamp, objects] : keyframes_)
    for (AnnotatedObject& object : objects) tracks[object.instance].push_back(&object);
  for (auto& [instance, track] : tracks) {
    for (std::size_t i = 0; i < track.size(); ++i) {
      const MovingBox& before = track[i == 0 ? i : i - 1]->box;
      const MovingBox& after = track[std::min(i + 1, track.size() - 1)]->box;
      AnnotatedObject& object = *track[i];
      if (after.time > before.time)
        object.box.velocity = (after.centre - before.centre) / (after.time - before.time);
      object.state = stateOf(object.box, track.size() > 1, object.state == BoxState::kMoves, min_speed);
    }
  }
}

const MovingObjects* RecordedObjects::nearest(const ros::Time& stamp) const {
  const MovingObjects* found = nullptr;
  double least = kMaxApart;
  const auto consider = [&](const auto& entry) {
    const double apart = std::abs((entry.first - stamp).toSec());
    if (apart <= least) least = apart, found = &entry.second;
  };
  const auto after = objects_.lower_bound(stamp);
  if (after != objects_.begin()) consider(*std::prev(after));
  if (after != objects_.end()) consider(*after);
  return found;
}

void RecordedObjects::compare(
    const PoseTrack& truth,
    const std::function<std::optional<Eigen::Isometry3d>(const std::string&, double)>& T_base_from,
    double offset, const ObjectMatching& matching, MotionReport& report) {
  std::vector<SeenScan> seen;
  for (const auto& [key, scan] : scans_) {
    const double stamp = key.first.toSec();
    const std::optional<Eigen::Isometry3d> mount = T_base_from(key.second, stamp);
    if (!mount || !truth.covers(stamp + offset)) continue;
    RadarScan radar_scan;
    radar_scan.returns = scan.returns;
    radar_scan.T_base_from_sensor = *mount;
    radar_scan.known_dynamic = scan.is_dynamic;
    SeenScan& entry = seen.emplace_back();
    entry.time = stamp + offset;
    // The residuals are without the motion of the vehicle.
    entry.returns = returnsOverGround(radar_scan, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  }
  completeBoxes(matching.min_speed);
  ObjectReport result;
  ObjectComparison comparison(truth, seen, matching, result);
  for (auto& [keyframe, boxes] : keyframes_) {
    const MovingObjects* message = nearest(keyframe - ros::Duration(offset));
    const double stamp = message == nullptr ? 0.0 : message->header.stamp.toSec();
    std::optional<Eigen::Isometry3d> T_base_from_tracks;
    if (message != nullptr && truth.covers(stamp + offset))
      T_base_from_tracks = T_base_from(withoutSlash(message->header.frame_id), stamp);
    if (!T_base_from_tracks) {
      ++report.keyframes_without_objects;
      continue;
    }
    for (AnnotatedObject& object : boxes) {
      object.box.centre += (stamp + offset - object.box.time) * object.box.velocity;
      object.box.time = stamp + offset;
    }
    comparison.add(stamp + offset, boxes, tracksOf(*message), *T_base_from_tracks);
  }
  if (topics_.size() < 3)
    for (MoverCounts& counts : result.kinds) counts.unseen = 0;
  if (result.keyframes > 0)
    report.objects = result;
  else
    report.objects_missing = fmt::format(
        "of {} keyframes none has objects within {} s, in a frame whose way to the base frame is known",
        keyframes_.size(), kMaxApart);
}

}  // namespace radar_dot::evaluation
