// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/annotation_labels.h"
#include "radar_dot/evaluation/mask_age.h"
#include "radar_dot/evaluation/mean.h"
#include "radar_dot/evaluation/trajectory.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/velocity_filter.h"

namespace radar_dot::evaluation {

/// The Doppler velocities of the nuScenes radars read about 0.35 % low against the displacement of the
/// poses, in all scenes of both vehicles: a planar radar takes returns from above or below its plane
/// as level, and their range rate is smaller by the cosine of the elevation.
inline constexpr double kNuscenesDopplerScale = 1.0035;

/// The positions of the nuScenes radars are where static objects stand half a scan cycle after the velocities
/// were measured, in a turning vehicle: the returns of turns in scenes of one vehicle say 0.0380 and 0.0373
/// s, give or take 0.0005.
inline constexpr double kNuscenesBearingDelay = 0.038;

/// What is evaluated, and with which parameters.
struct VelocityEvaluationOptions {
  std::vector<std::string> channels;  ///< empty = every radar of the scene
  ExtractionParams extraction;
  /// Model, solver and passes vary over the table; everything else is taken from here.
  EgoVelocityParams estimator;
  double window = 0.1;  ///< s, age of the oldest scan of a sweep
  /// s, by which the bearings of returns are later than their velocities. Every scan is turned back by the
  /// yaw rate estimated last.
  double bearing_delay = 0.0;
  bool filter = false;  ///< evaluate the causal filter over sweeps as well
  VelocityFilterParams filter_params;
  bool filter_radars = true;  ///< the filter takes each radar by itself; else the joint estimates
  /// rad, by channel: added to the yaw of the calibrated mount.
  std::map<std::string, double> mount_yaw_corrections;
  LabelParams labels;
  /// Folder with <stem of the image>.png of saved masks: the returns of a scan in the newest mask at or
  /// before it are known to move. They are brought to the time of the mask with the velocity estimated last.
  /// Empty = no masks.
  std::string mask_directory;
  std::string mask_channel = "CAM_FRONT";
  double max_mask_age = kMaxMaskAge;  ///< s, from the image of a mask to the scan
  /// s, from an image to the time its mask is known. A mask needs the second image of its pair: 0.5 for the
  /// masks of pairs of keyframes is what a vehicle would have; 0 lets a mask speak from its image on.
  double mask_delay = 0.0;
};

/// The paper's four estimators, planar model: B1 least squares on all returns, A1 on the static
/// ones, B2 and A2 the same with RANSAC; and "robust": RANSAC with reweighted refinement.
inline constexpr std::array<const char*, 5> kVariants = {"B1", "A1", "B2", "A2", "robust"};

/// Errors of one motion model against the displacement of the true poses.
struct ModelErrors {
  Mean vx, vy;    ///< m/s, absolute
  Mean yaw_rate;  ///< rad/s, absolute; empty for models without yaw rate
  /// Squared error over the estimate's own variance, of observed axes: about 1 where the covariance is
  /// right, more where it is too small or the ground truth has errors of its own.
  Mean normalised_vx, normalised_vy, normalised_yaw_rate;
  ModelErrors& operator+=(const ModelErrors& other);
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
  MountError& operator+=(const MountError& other) {
    numerator += other.numerator;
    denominator += other.denominator;
    return *this;
  }
};

/// Results of one scene, or of several merged by operator+=.
struct VelocityReport {
  std::string scene;
  std::size_t frames = 0;  ///< pairs of consecutive keyframes with a true displacement
  /// Radar files the tables list and the disk lacks, by channel: missing, listed. Only where some are.
  std::map<std::string, std::pair<std::size_t, std::size_t>> missing_files;
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
  VelocityReport& operator+=(const VelocityReport& other);
};

/// None of the radar files a scene needs is on disk.
class NoRadarFiles : public dataset::DatasetError {
 public:
  using DatasetError::DatasetError;
};

/// Evaluates one scene.
/// @throws NoRadarFiles where a scene, or a requested channel of it, has no file; dataset::DatasetError
///         for unreadable files, a correction
///         for a radar the scene does not have, keyframes out of order, or poses that do not cover them, and
///         for a folder of masks without one of the scene; std::invalid_argument for a limit on the masks'
///         age that is invalid.
VelocityReport evaluateEgoVelocity(const dataset::Tables& tables, dataset::Index scene,
                                   const VelocityEvaluationOptions& options = {});

}  // namespace radar_dot::evaluation
