// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/annotation_labels.h"
#include "radar_dot/evaluation/evaluation_inputs.h"
#include "radar_dot/evaluation/figures.h"
#include "radar_dot/evaluation/pose_track.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/velocity_filter.h"

namespace radar_dot::evaluation {

/// What is evaluated, and with which parameters.
struct VelocityEvaluationOptions {
  /// Model, solver and passes vary over the table; everything else is taken from here. The entry of `radars`
  /// whose topic ends like the name of a channel, in small letters (radar_front: RADAR_FRONT), holds for that
  /// radar.
  EgoVelocityConfig ego_velocity;
  std::vector<std::string> radar_channels;
  std::vector<std::string> mount_yaw_corrections;  ///< "CHANNEL=RAD", instead of those in `radars`
  bool filter_radars = true;
  LabelParams labels;
  /// The returns of a scan in the newest mask at or before it are known to move. They are brought to the time
  /// of the mask with the velocity estimated last.
  SavedMaskOptions masks;

  /// Those that are in no section of a configuration file.
  void describe(FieldList& fields);
};

/// @throws InvalidParameter, also for what does not go together
void validate(const VelocityEvaluationOptions& options);

/// The paper's four estimators, planar model: B1 least squares on all returns, A1 on the static
/// ones, B2 and A2 the same with RANSAC; and "robust": RANSAC with reweighted refinement.
inline constexpr std::array<const char*, 5> kVariants = {"B1", "A1", "B2", "A2", "robust"};

/// Errors of one motion model against the displacement of the true poses.
struct ModelErrors {
  Mean vx, vy;    ///< m/s, absolute
  Mean velocity;  ///< m/s, length of the error in the plane: |v - v_gt|
  Mean yaw_rate;  ///< rad/s, absolute; empty for models without yaw rate
  /// Squared error over the estimate's own variance, of what is observed or assumed: about 1 where the
  /// covariance is right, more where it is too small or the ground truth has errors of its own.
  Mean normalised_vx, normalised_vy, normalised_yaw_rate;
  void describe(Figures& figures);
};

/// How far a radar's mount is turned from its calibration, as the true motion shows it. With the
/// residual e = d + u.v of a static return at the true velocity v of the radar, and the speed
/// c = (z x u).v across the line of sight, a mount that is really turned by psi leaves e = -psi c.
struct MountError {
  double numerator = 0.0;    ///< -sum c e
  double denominator = 0.0;  ///< sum c^2
  double yaw() const {       ///< psi, rad; NaN while the radar never moved
    return denominator > 0.0 ? numerator / denominator : std::numeric_limits<double>::quiet_NaN();
  }
  void describe(Figures& figures);
};

/// Results of one scene, or of several merged by operator+=.
struct VelocityReport {
  std::string scene;
  std::size_t frames = 0;                       ///< pairs of consecutive keyframes with a true displacement
  std::size_t refused = 0;                      ///< of them, refused by the estimator in use
  std::map<std::string, std::size_t> refusals;  ///< by reason
  std::map<std::string, Mean> mae;              ///< by variant: |v - v_gt|, m/s
  std::map<std::string, ModelErrors> models;    ///< by motion model
  /// Of the latest sweep at or before the middle of a pair, as it is, and filtered: what a vehicle has then.
  ModelErrors causal, filtered;
  std::size_t filter_rejected = 0, filter_starts = 0;  ///< sweeps
  /// Forward speed against the rear wheels of the CAN bus, m/s: of the estimate (planar_yaw), and
  /// of the poses themselves, which shows how much of an error is the ground truth's own.
  Mean wheel_estimate, wheel_ground_truth;
  std::size_t sweeps = 0;          ///< estimates along the trajectory
  std::size_t sweeps_refused = 0;  ///< of them, refused
  TrajectoryError gt_heading, own_heading;
  std::map<std::string, MountError> mounts;  ///< by channel
  Confusion dynamic;                         ///< every range
  Confusion dynamic_70m;                     ///< returns within 70 m of the base frame's origin
  void describe(Figures& figures);
};

/// Evaluates one scene.
/// @throws dataset::DatasetError where a scene, or a requested channel of it, has no file, for unreadable
/// files,
///         a correction for a radar the scene does not have, keyframes out of order, or poses that do not
///         cover them, and for a folder of masks without one of the scene; std::invalid_argument for a limit
///         on the masks' age that is invalid.
VelocityReport evaluateEgoVelocity(const dataset::Tables& tables, dataset::Index scene,
                                   const VelocityEvaluationOptions& options = {});

/// Plain-text tables for a terminal; the last row is the overall result.
std::string formatTable(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);
/// Of the form of figures.h: "mae", "models", "causal", "trajectory", "dynamic" and others are objects.
std::string formatJson(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);
/// The columns of the tables, without the mounts.
std::string formatCsv(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);

}  // namespace radar_dot::evaluation
