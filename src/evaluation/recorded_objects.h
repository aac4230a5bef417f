// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <radar_dot/MovingObjects.h>
#include <ros/time.h>
#include <rosbag/message_instance.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "object_comparison.h"
#include "radar_dot/evaluation/motion_comparison.h"

namespace radar_dot::evaluation {

/// Moving objects of a recording, and the annotated boxes that they are compared with.
class RecordedObjects {
 public:
  /// @param topics  of MovingObjects, the boxes of bag::toBoxes, and, where they are there, radar/static and
  ///                radar/dynamic of EgoVelocity; or none
  explicit RecordedObjects(std::vector<std::string> topics) : topics_(std::move(topics)) {}
  const std::vector<std::string>& topics() const { return topics_; }

  /// Any message. @throws std::runtime_error that names the topic, for a cloud without x, y, z, or of a size
  /// that contradicts its fields
  void add(const rosbag::MessageInstance& message);

  /// Of the boxes; empty: there are none.
  const std::string& frame() const { return frame_; }

  /// Compares as evaluateObjects does. A keyframe takes the objects with the nearest stamp, to which its
  /// boxes move along their tracks.
  /// @param truth        T_map_from_base, where "map" is the frame of the boxes
  /// @param T_base_from  a frame at a stamp (s); none where it is not known
  /// @param offset       s, to add to the stamps of objects and returns
  void compare(const PoseTrack& truth,
               const std::function<std::optional<Eigen::Isometry3d>(const std::string&, double)>& T_base_from,
               double offset, const ObjectMatching& matching, MotionReport& report);

 private:
  struct Scan {
    std::vector<DopplerReturn> returns;  // their Doppler velocity is that over ground
    std::vector<std::uint8_t> is_dynamic;
  };
  void addBoxes(const visualization_msgs::MarkerArray& boxes);
  void addReturns(const sensor_msgs::PointCloud2& cloud, bool dynamic);
  void completeBoxes(double min_speed);
  const MovingObjects* nearest(const ros::Time& stamp) const;

  std::vector<std::string> topics_;
  std::string frame_;
  std::map<ros::Time, MovingObjects> objects_;
  std::map<ros::Time, std::vector<AnnotatedObject>> keyframes_;
  std::map<std::pair<ros::Time, std::string>, Scan> scans_;
};

}  // namespace radar_dot::evaluation
