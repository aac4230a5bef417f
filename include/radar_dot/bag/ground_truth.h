// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/CompressedImage.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::bag {

/// Half of the interval over which egoTwists differentiates, s: long against the jitter of the
/// poses, short against the dynamics of a car.
inline constexpr double kTwistHalfWindow = 0.1;

/// Twist at each pose (rows of tables.ego_poses in time order, stamps all different): central
/// difference of the poses interpolated at t - half_window and t + half_window (s), one-sided at
/// the ends, without a covariance. Zero where there is only one pose.
std::vector<StampedTwist> egoTwists(const dataset::Tables& tables, const std::vector<dataset::Index>& poses,
                                    double half_window = kTwistHalfWindow);

/// map -> base_link with the twist in base_link; covariances zero: this is the reference.
nav_msgs::Odometry toOdometry(const dataset::EgoPose& pose, const StampedTwist& twist);

/// The annotated boxes of a keyframe as cubes in the map frame, after a marker that deletes those
/// of the keyframe before. The marker's id is the instance's row, its text the category; red = moves,
/// blue = does not.
visualization_msgs::MarkerArray toBoxes(const dataset::Tables& tables, dataset::Index sample);

/// Union of the masks of the moving instances of one image as PNG (mono8, 255 = moves).
sensor_msgs::CompressedImage toDynamicMask(const dataset::Tables& tables,
                                           const std::vector<const dataset::InstanceMask*>& instances,
                                           const std::string& frame, const ros::Time& stamp);

}  // namespace radar_dot::bag
