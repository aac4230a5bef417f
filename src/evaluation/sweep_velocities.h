// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "mask_feedback.h"
#include "mask_folder.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "radar_dot/radar/odometry.h"
#include "radar_scene.h"

namespace radar_dot::evaluation {

/// A velocity estimated from one sweep, or filtered over the sweeps up to it.
struct EstimatedVelocity : StampedTwist {
  EstimatedVelocity(double stamp, const EgoVelocityResult& result);
  EstimatedVelocity(const VelocityFilter::State& state, const EgoVelocityResult& result);
  /// At constant acceleration; an estimate of a single sweep has none.
  EstimatedVelocity broughtTo(double when) const;

  std::array<bool, 6> observed;                            ///< vx vy vz wx wy wz
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of [vx, vy, yaw rate], per second
};

/// The latest velocity at or before `time`; null where there is none.
const EstimatedVelocity* latestAt(const std::vector<EstimatedVelocity>& velocities, double time);
/// Acceleration (m/s^2) and yaw rate (rad/s) from the velocities up to `time`; zero where none is near.
Eigen::Vector3d accelerationAt(const std::vector<EstimatedVelocity>& velocities, double time);
double yawRateAt(const std::vector<EstimatedVelocity>& velocities, double time);

/// Brings the bearings of scans to the time of their velocities.
void turnBearings(std::vector<RadarScan>& scans, double bearing_delay, double yaw_rate);

/// What saved masks tell the estimator; nothing without them.
class SavedMasks {
 public:
  SavedMasks(const dataset::Tables& tables, dataset::Index scene, const VelocityEvaluationOptions& options);
  /// Marks the returns of the scans of an estimate at `time`, with the velocity estimated last before.
  void mark(std::vector<RadarScan>& scans, const std::vector<EstimatedVelocity>& velocities, double time);

 private:
  std::optional<MaskFolder> folder_;
  MaskFeedback feedback_;
};

/// Estimates of every sweep of a scene in time order.
struct SweepVelocities {
  std::vector<EstimatedVelocity> velocities;
  std::vector<EstimatedVelocity> filtered;  ///< of the same sweeps; empty without the filter
  std::size_t count = 0, refused = 0;
  std::size_t filter_rejected = 0, filter_starts = 0;
};

SweepVelocities sweepVelocities(const RadarScene& scene, const VelocityEvaluationOptions& options,
                                SavedMasks& masks);

}  // namespace radar_dot::evaluation
