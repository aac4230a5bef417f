// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/PointCloud2.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace radar_dot::test {

/// Pose and velocity of the base frame; vy = 0, everything in the plane.
struct TrueState {
  double x = 0.0, y = 0.0, yaw = 0.0;  ///< m, rad, map frame
  double speed = 0.0;                  ///< m/s, along the base frame's x axis
  double yaw_rate = 0.0;               ///< rad/s
};

/// A drive that speeds up, slows down and turns both ways.
class SyntheticDrive {
 public:
  static constexpr double kStart = 1'600'000'000.0;  ///< s, stamp of its beginning
  explicit SyntheticDrive(double duration = 12.0);
  double duration() const noexcept { return duration_; }  ///< s
  TrueState at(double seconds) const;                     ///< s since the beginning
 private:
  double duration_;
  std::vector<TrueState> states_;  // one per millisecond
};

/// A radar as the bag has it: topic and frame are "radar_front" and so on.
struct SyntheticRadar {
  std::string name;
  geometry_msgs::TransformStamped mount;  ///< base_link -> name
};
/// The five radars of a nuScenes vehicle.
std::vector<SyntheticRadar> syntheticRadars();

/// One scan with the 18 fields of nuScenes: `points` returns with exact Doppler, the last fifth
/// moves by 3 to 12 m/s along the line of sight; every tenth has invalid_state 4. The field `id`
/// is the number of the return.
sensor_msgs::PointCloud2 syntheticScan(const TrueState& state, std::size_t radar, const ros::Time& stamp,
                                       unsigned seed, int points = 50);

/// True for the returns of syntheticScan that move.
inline bool isMoving(int id, int points = 50) { return id >= points - points / 5; }
/// True for the returns of syntheticScan that the nuScenes filters refuse.
inline bool isRefused(int id) { return id % 10 == 3; }

/// The offset of a field in a point. @throws std::out_of_range when there is none.
std::size_t offsetOf(const sensor_msgs::PointCloud2& cloud, const std::string& field);

using ScanKey = std::pair<std::string, ros::Time>;  ///< frame and stamp

/// Writes the drive as a bag: five radars at 13 Hz that are not synchronised, /tf_static,
/// /ground_truth/odom and /tf (map -> base_link) at 50 Hz, /can/imu at 100 Hz.
/// @return the scans that are in it
std::map<ScanKey, sensor_msgs::PointCloud2> writeSyntheticBag(const SyntheticDrive& drive,
                                                              const std::filesystem::path& file);

}  // namespace radar_dot::test
