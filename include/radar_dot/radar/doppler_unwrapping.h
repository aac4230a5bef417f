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
/// A velocity that is off by less than V tells the wraps of all static returns. Starts are the latest
/// velocity and its neighbours 2 V away; where the vehicle may have changed its speed by more than V / 2
/// since, or where nothing is known, also forward speeds up to 60 m/s in steps of V. Each gives a hypothesis:
/// the returns unwrapped to what a static world would show, and their estimate, repeated until no wrap
/// changes. The likelihood of all returns, of radars without an ambiguity or with another one as well,
/// compares the hypotheses. What differs between them for a single radar is the cosine of the bearing: a few
/// degrees of bearings do not tell.
///
/// The answer is the likeliest hypothesis that can follow from the latest velocity by accelerations of tyres
/// (AccelerationTracker::kMaxAcceleration), if no other that can is about as likely, and none at all is far
/// likelier. Without a latest velocity, where the likelihood does not decide, a run starts below the
/// ambiguity: the answer is the one likely hypothesis slower than V. In all other cases the status is
/// kAmbiguous.
class DopplerUnwrapping {
 public:
  /// EgoVelocityEstimator::estimate, to which it comes down without a finite unambiguous_velocity.
  /// @param scans  where the velocity is known, those of an ambiguous radar get returns with unwrapped range
  ///         rates, which stay here and are valid until the next call. Returns that move are unwrapped as if
  ///         they stood still: what is known of their own speed holds modulo 2 V.
  /// @param latest the velocity known last, with its covariance; none before the first of a run
  EgoVelocityResult estimate(EgoVelocityEstimator& estimator, std::vector<RadarScan>& scans, double time,
                             const Eigen::Vector3d& acceleration, const std::optional<StampedTwist>& latest,
                             const std::optional<AngularVelocity>& known = std::nullopt);

  /// Whether the range rates of any scan are ambiguous.
  static bool needed(const std::vector<RadarScan>& scans);
  /// One line where the latest estimate rests on the rule of the start; empty otherwise.
  const std::string& assumption() const noexcept { return assumption_; }

 private:
  std::vector<std::vector<DopplerReturn>> returns_;  // of the ambiguous scans
  std::string assumption_;
};

}  // namespace radar_dot
