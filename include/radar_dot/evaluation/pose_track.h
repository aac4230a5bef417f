// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/evaluation/figures.h"

namespace radar_dot::evaluation {

/// The true motion of a vehicle, from poses sorted by time.
class PoseTrack {
 public:
  /// @throws std::invalid_argument for fewer than two poses or times that do not increase.
  explicit PoseTrack(std::vector<StampedPose> poses);

  double begin() const noexcept { return poses_.front().time; }
  double end() const noexcept { return poses_.back().time; }

  /// Is `time` covered, give or take `slack` seconds?
  bool covers(double time, double slack = 0.1) const noexcept {
    return time >= begin() - slack && time <= end() + slack;
  }

  /// Interpolated; beyond the ends at the constant velocity of the nearest quarter of a second.
  Eigen::Isometry3d at(double time) const;

  /// Mean velocity between two times: the displacement (p(t1) - p(t0)) / (t1 - t0), in the base
  /// frame at the middle. There the chord is parallel to the mid-interval velocity of a steady turn;
  /// in the frame at t0 it would appear turned by half the angle of the turn.
  Eigen::Vector3d meanVelocity(double t0, double t1) const;

  /// Mean yaw rate between two times, rad/s.
  double meanYawRate(double t0, double t1) const;

 private:
  std::vector<StampedPose> poses_;
};

/// How far an estimated trajectory strays from the true one. Both start at the same pose; no
/// alignment is applied.
struct TrajectoryError {
  double squared_error = 0.0;  ///< m^2, summed over the poses
  std::size_t count = 0;       ///< poses compared
  double end_error = 0.0;      ///< m, at the last pose
  double distance = 0.0;       ///< m, length of the true path

  double rootMeanSquare() const;  ///< absolute trajectory error, m; NaN without poses
  double driftPercent() const;    ///< end error in % of the distance; NaN below 10 m
  void describe(Figures& figures);
};

/// Compares positions at the times of the estimate.
TrajectoryError compareTrajectory(const std::vector<StampedPose>& estimate, const PoseTrack& truth);

}  // namespace radar_dot::evaluation
