// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <random>
#include <vector>

#include "radar_dot/objects/object_tracker.h"

namespace radar_dot::test {

/// A point with constant velocity, world frame.
struct Mover {
  Eigen::Vector2d start;     ///< m, at time 0
  Eigen::Vector2d velocity;  ///< m/s
  Eigen::Vector2d at(double time) const { return start + time * velocity; }
};

/// Movers seen by radars at the corners of a vehicle that drives a curve.
struct ObjectWorld {
  std::vector<Mover> movers;
  std::vector<Eigen::Vector2d> radars = {{3.4, 0.0}, {2.4, 0.8}, {2.4, -0.8}, {-0.6, 0.6}, {-0.6, -0.6}};
  double speed = 8.0, yaw_rate = 0.1;  ///< of the vehicle, m/s and rad/s
  double range_std = 0.2, azimuth_std = 0.01, doppler_std = 0.1;
  double clutter = 0.0;    ///< mean number of false returns in a scan, anywhere within 60 m
  double detection = 1.0;  ///< probability that a scan sees a mover
  std::mt19937 random{1};

  Eigen::Isometry3d poseAt(double time) const;
  /// What one radar sees at `time`.
  std::vector<ReturnOverGround> scan(std::size_t radar, double time);
  /// Runs scans of all radars at 13 Hz, not synchronised, from `begin` to `end` (s) through a tracker.
  void run(ObjectTracker& tracker, double begin, double end);
};

}  // namespace radar_dot::test
