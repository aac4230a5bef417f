// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "mask_folder.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "radar_dot/objects/mask_marking.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/radar/sweep_estimator.h"
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

/// The scans of a sweep at `time` (s), and the stamp of the scan whose arrival showed that it is complete.
struct SceneSweep {
  double time = 0.0, complete = 0.0;
  std::vector<RadarScan> scans;
};
/// All sweeps of a scene, which must outlive them, as on a vehicle where each scan arrives at its stamp.
std::vector<SceneSweep> assembleSweeps(const RadarScene& scene, const SweepParams& params);

/// What the returns of every scan are, by radar and scan, as a vehicle tells it while it drives; of scans
/// without an estimate nothing.
std::vector<std::vector<std::vector<ReturnLabel>>> returnLabels(const RadarScene& scene);

/// Estimates of every sweep of a scene in time order.
struct SweepVelocities {
  std::vector<EstimatedVelocity> velocities;
  std::vector<EstimatedVelocity> filtered;  ///< of the same sweeps; empty without the filter
  std::size_t count = 0, refused = 0;
  std::size_t filter_rejected = 0, filter_starts = 0;
};

/// Estimates the sweeps of a scene one after the other, as a vehicle does, with what saved masks tell.
class SweepRunner {
 public:
  /// `scene` is that of `index` and must outlive it, as `tables` and `options` must.
  SweepRunner(const dataset::Tables& tables, dataset::Index index, const RadarScene& scene,
              const VelocityEvaluationOptions& options);

  /// Estimates the sweeps up to `time` (s) that are still to come.
  const SweepVelocities& upTo(double time);
  /// Marks the returns of scans that lie in saved masks, with the velocities so far.
  void mark(std::vector<RadarScan>& scans);
  /// After the sweeps so far.
  const SweepEstimator& estimator() const { return estimator_; }

 private:
  const EgoVelocityConfig& config_;
  std::vector<SceneSweep> sweeps_;
  std::size_t next_ = 0;
  SweepEstimator estimator_;
  std::optional<MaskFolder> masks_;
  SweepVelocities velocities_;
  TwistHistory raw_;  // of single sweeps, for masks
};

/// Of all sweeps.
SweepVelocities sweepVelocities(const dataset::Tables& tables, dataset::Index index, const RadarScene& scene,
                                const VelocityEvaluationOptions& options);

}  // namespace radar_dot::evaluation
