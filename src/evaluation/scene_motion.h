// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "radar_dot/common/twist_history.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_dot/radar/sweep_estimator.h"
#include "radar_dot/vision/mask_footprint.h"
#include "radar_dot/vision/recent_scans.h"
#include "sweep_velocities.h"

namespace radar_dot::evaluation {

/// What a vehicle knows of its motion and of the radar returns around it once a time has come: what
/// EgoVelocity has published by then, as DynamicSegmentation takes it.
class SceneMotion {
 public:
  /// Both must outlive it.
  SceneMotion(const RadarScene& radar, const SegmentationEvaluationOptions& options);

  /// Takes the sweeps that are complete at `time` (s).
  void advanceTo(double time);
  /// The newest mask, whose returns the sweeps to come leave out.
  void setMask(StampedMask mask) { mask_ = std::move(mask); }

  /// None where the twists do not cover it.
  std::optional<StampedTwist> mean(double begin, double end) const;
  /// Pose of the base at `end`, in its frame at `begin`, with the rotation of the options.
  std::optional<Eigen::Isometry3d> between(double begin, double end, double max_hold) const;
  /// Of the latest twist; zero before the first.
  Eigen::Matrix<double, 6, 6> covariance() const;
  /// @param label  kStatic or kDynamic
  std::vector<CloudPoint> pointsAt(ReturnLabel label, double time) const;

 private:
  void take(SceneSweep& sweep);
  void keepPoints(const SceneSweep& sweep, const EgoVelocityResult& result);

  const RadarScene& radar_;
  const SegmentationEvaluationOptions& options_;
  std::vector<SceneSweep> sweeps_;
  std::size_t next_ = 0;
  SweepEstimator estimator_;
  TwistHistory twists_;  // on ego/twist
  TwistHistory raw_;     // of single sweeps, for masks
  RecentScans static_, dynamic_;
  std::optional<StampedMask> mask_;
};

}  // namespace radar_dot::evaluation
