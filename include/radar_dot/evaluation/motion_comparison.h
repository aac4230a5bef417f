// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/evaluation/figures.h"
#include "radar_dot/evaluation/object_evaluation.h"
#include "radar_dot/evaluation/pose_track.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot::evaluation {

/// Where the velocity of a reference that has poses and twists comes from.
enum class ReferenceVelocity { kAuto, kTwist, kPose };

/// How a motion is compared with another.
struct ComparisonOptions {
  double time_offset = 0.0;
  bool align_time = false;
  double max_time_offset = 0.5;
  ReferenceVelocity reference_velocity = ReferenceVelocity::kAuto;
  double interval = 0.2;
  double max_gap = 0.5;
  void describe(FieldList& fields);
};

/// What a source of motion sent, and what of it was of no use.
struct StreamCounts {
  std::uint64_t messages = 0;
  std::uint64_t not_finite = 0, no_fix = 0;  ///< left out
  std::uint64_t zero_stamps = 0;             ///< the time of recording is taken
  std::uint64_t unordered = 0;               ///< earlier than one before, and sorted in
  std::uint64_t repeated = 0;                ///< of the time of another, and left out
  double rate = 0.0, longest_gap = 0.0;      ///< Hz; s
  void describe(Figures& figures);
};

/// The motion of the base frame as one source has it, in the order of time, no time twice. Both lists have
/// times of their own; either may be empty.
struct RecordedMotion {
  std::vector<StampedTwist> twists;
  std::vector<StampedPose> poses;
  StreamCounts counts;

  /// Sorts, leaves out what has the time of another, and counts; `times` of the list that counts.
  void putInOrder();
};

/// A motion that others are compared with, at any time.
class ReferenceMotion {
 public:
  /// @throws std::runtime_error where nothing tells a velocity
  ReferenceMotion(const RecordedMotion& motion, const ComparisonOptions& options);

  /// Velocity of the base frame; a component that is not known has kUnobservedVariance. Between twists it is
  /// linear; from poses, it is the mean of an interval around. None outside, and in gaps.
  std::optional<StampedTwist> at(double time) const;
  /// From poses, the mean of that interval; else at its middle.
  std::optional<StampedTwist> over(double begin, double end) const;
  /// Integrated from twists where there are no poses; null where there is neither.
  const PoseTrack* track() const { return track_ ? &*track_ : nullptr; }

 private:
  std::vector<StampedTwist> twists_;
  std::vector<double> pose_times_;
  std::optional<PoseTrack> track_;
  bool is_from_poses_ = false;
  double half_interval_, max_gap_;
};

/// The time that must be added to the stamps of an estimate to match a reference.
struct TimeOffset {
  double offset = std::numeric_limits<double>::quiet_NaN();  ///< s; NaN where it does not show
  double sigma = std::numeric_limits<double>::quiet_NaN();   ///< s
  std::string why_not;                                       ///< why it does not show; empty: it does
};
/// Of largest likelihood, of speed and yaw rate that are equal but for a bias and noise of unknown strength.
TimeOffset findTimeOffset(const std::vector<StampedTwist>& estimate, const ReferenceMotion& reference,
                          double max_offset);

/// Errors of one component, estimate less reference.
struct ComponentErrors {
  std::vector<double> errors;      ///< m/s or rad/s
  std::vector<double> normalised;  ///< over the estimate's own sigma, where it has one
  /// "mae", "rmse", "bias", "p95" (of the absolute error), "nees", "count".
  void describe(Figures& figures);
};

/// Squared errors over the estimate's covariance.
struct JointErrors {
  std::vector<double> nees;             ///< over the number of components
  std::uint64_t within_95 = 0;          ///< within the 95 % limit of chi-square
  std::vector<Eigen::Vector3d> errors;  ///< of vx, vy, yaw rate, over sigma; 0: not known
  /// The mean, which is 1 where the covariance is right, within limits that hold in 95 % of cases, given as
  /// many independent errors as their correlation leaves.
  double mean() const;
  double effectiveCount() const;
  double lower() const;
  double upper() const;
  void describe(Figures& figures) const;

  double degrees_of_freedom = 0.0;  ///< sum
};

/// A path against the true one.
struct PathErrors {
  TrajectoryError start;  ///< both start at the same pose
  double aligned_squared =
      std::numeric_limits<double>::quiet_NaN();  ///< m^2, sum after the best rigid motion
  void describe(Figures& figures) const;
};

/// All of a recording.
struct MotionReport {
  std::string scene;
  StreamCounts estimate, reference;
  std::uint64_t compared = 0, outside = 0;  ///< estimates; outside: without a reference at their time
  TimeOffset time_offset;
  double applied_offset = 0.0;
  ComponentErrors vx, vy, yaw_rate;
  JointErrors joint;
  std::optional<PathErrors> reference_heading, own_heading, odometry;
  std::optional<SegmentationReport> masks;
  std::uint64_t masks_without_truth = 0;
  std::optional<ObjectReport> objects;
  std::uint64_t keyframes_without_objects = 0;
  std::string objects_missing;  ///< why they are not compared; empty: they are, or are not wanted
  void describe(Figures& figures);
};

/// Compares an estimate with a reference; `odometry` may have no poses.
/// @param keyframes  times (s) in order, between every two of which velocities are compared once, at the
/// middle, by the latest estimate before it, brought to it; empty: at every estimate. Paths and the time
/// offset are those of all estimates in any case.
/// @throws std::runtime_error where no estimate has a reference at its time
MotionReport compareMotion(const RecordedMotion& estimate, const RecordedMotion& odometry,
                           const RecordedMotion& reference, const ComparisonOptions& options,
                           const std::vector<double>& keyframes = {});

/// Tables for a terminal.
std::string formatTable(const MotionReport& report);

}  // namespace radar_dot::evaluation

namespace radar_dot {

template <>
struct EnumNames<evaluation::ReferenceVelocity> {
  static constexpr EnumName<evaluation::ReferenceVelocity> kValues[] = {
      {evaluation::ReferenceVelocity::kAuto, "auto", "the twists, but the poses where all twists are zero"},
      {evaluation::ReferenceVelocity::kTwist, "twist", "the twists"},
      {evaluation::ReferenceVelocity::kPose, "pose", "the displacement of the poses over the interval"}};
};

}  // namespace radar_dot
