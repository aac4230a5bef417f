// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// Velocity from radars that report range rates modulo twice their unambiguous velocity V: a true d is
/// reported as the d + 2 V k that lies in [-V, V).
///
/// A velocity near the true one tells the wraps of all static returns, so that the estimator solves what is
/// left. Such velocities are the latest one where the vehicle cannot have left its surroundings, and else
/// forward speeds up to 60 m/s in steps of V. Each gives a hypothesis: the returns unwrapped to what a static
/// world would show, and their estimate, repeated until no wrap changes. The likelihood of all returns, of
/// radars without an ambiguity or with another one as well, compares the hypotheses; its evidence is the
/// cosine of the bearing, so that a few degrees of bearings hold none.
///
/// The answer is a hypothesis that can follow from the latest velocity by accelerations of tyres
/// (AccelerationTracker::kMaxAcceleration) and that no other outdoes or, among those that can follow, equals.
/// Where there is no latest velocity and the evidence does not decide, a run starts below the ambiguity: the
/// answer is the one hypothesis slower than V. In all other cases the status is kAmbiguous.
class DopplerUnwrapping {
 public:
  /// EgoVelocityEstimator::estimate, to which it comes down without a finite unambiguous_velocity.
  /// @param scans  where the velocity is known, those of an ambiguous radar get returns with unwrapped range
  ///         rates, which stay here and are valid until the next call. Returns that move are unwrapped as if
  ///         they stood still: what is known of their own speed holds modulo 2 V.
  /// @param latest the velocity known last, with its covariance; none before the first of a run
  EgoVelocityResult estimate(EgoVelocityEstimator& estimator, std::vector<RadarScan>& scans, double time,
                             const Eigen::Vector3d& acceleration, const std::optional<StampedTwist>& latest);

  /// Whether the range rates of any scan are ambiguous.
  static bool needed(const std::vector<RadarScan>& scans);
  /// One line where the latest estimate rests on the rule of the start; empty otherwise.
  const std::string& assumption() const noexcept { return assumption_; }

 private:
  std::vector<std::vector<DopplerReturn>> returns_;  // of the ambiguous scans
  std::string assumption_;
};

}  // namespace radar_dot
