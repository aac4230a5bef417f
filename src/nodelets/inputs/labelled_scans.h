// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/moment.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/radar/returns_over_ground.h"

namespace radar_dot {

/// A scan of one radar: what radar/static and radar/dynamic say of it. Points in the sensor frame.
struct LabelledScan {
  ros::Time stamp;
  std::string frame;
  std::size_t radar = 0;  ///< number of its frame, the same in all scans
  /// None: the cloud did not come.
  std::optional<std::vector<CloudPoint>> still, moving;
  Moment arrival;  ///< of its first cloud
  bool complete() const { return still && moving; }
};

/// Puts the two clouds of a scan together again. They belong together where frame and stamp are equal, and
/// may come in any order.
class LabelledScans {
 public:
  /// @throws std::invalid_argument as pointsOf(), for a cloud without residuals, and for one whose scan was
  ///         taken already, or that is older than one of its radar that was
  void add(const sensor_msgs::PointCloud2& cloud, ReturnLabel label, const Moment& now);
  /// The scans that are complete, in the order of their stamps, up to the first that still waits. One that
  /// has waited longer than `timeout` (s) goes as it is.
  std::vector<LabelledScan> take(double timeout, const Moment& now);
  /// True when no scan waits: a sweep is complete.
  bool empty() const noexcept { return waiting_.empty(); }
  void clear();

 private:
  std::size_t numberOf(const std::string& frame);

  std::map<std::pair<ros::Time, std::string>, LabelledScan> waiting_;
  std::map<std::string, std::size_t> numbers_;  // of the radars, by frame
  std::map<std::string, ros::Time> taken_;      // latest stamp by frame
};

/// The returns of a scan over ground. Their velocities are the residuals, as EgoVelocity has found them with
/// all that it knows of its radars; those it called dynamic stay so, others may become so by the thresholds.
/// @param velocity  of the vehicle; only for how sure the velocities are
std::vector<ReturnOverGround> returnsOf(const LabelledScan& scan, const Eigen::Isometry3d& T_base_from_sensor,
                                        const StampedTwist& velocity, const OverGroundParams& params);

}  // namespace radar_dot
