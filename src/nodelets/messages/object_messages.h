// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <set>

#include "nodelets/messages/object_arrays.h"
#include "radar_dot/MovingObjects.h"
#include "radar_dot/objects/object_tracker.h"

namespace radar_dot {

/// Where objects are published: the frame of the messages, seen from that of the tracks.
struct FrameOfObjects {
  Eigen::Isometry2d T_frame_from_odom = Eigen::Isometry2d::Identity();
  double height = 0.0;  ///< m, of the base frame's origin in the frame
};

/// What is planar of a pose: x, y and the heading.
Eigen::Isometry2d planarPose(const Eigen::Isometry3d& pose);

/// A track as it is published: position, velocity and covariances turned into the frame.
/// @param stamp          of the track's state
/// @param image_max_age  s before `stamp`; a box of an older image is left out
MovingObject objectMessage(const ObjectTrack& track, const ros::Time& stamp, const FrameOfObjects& frame,
                           double image_max_age);

/// The same objects for others. Their heading is the direction in which they move; the extent is nominal,
/// that of the markers: it is not measured. What is not known (heights, rates, accelerations, extent) has the
/// variance kUnknownVariance.
inline constexpr double kUnknownVariance = 1e6;
derived_object_msgs::ObjectWithCovarianceArray objectsWithCovariance(const MovingObjects& objects);
/// @param objects  in a frame fixed to the world: planners do not turn the velocities
costmap_converter::ObstacleArrayMsg obstaclesOf(const MovingObjects& objects);

/// Pictures of objects for rviz: for each a cylinder, an arrow as long as it moves in one second, and its id
/// with its speed. Remembers which objects are on show.
class ObjectMarkers {
 public:
  /// @param lifetime  s, after which a marker disappears by itself
  visualization_msgs::MarkerArray update(const MovingObjects& objects, double lifetime);
  /// Deletes whatever is on show.
  visualization_msgs::MarkerArray deleteAll(const std_msgs::Header& header);

 private:
  std::set<std::int32_t> shown_;
};

}  // namespace radar_dot
