// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <string>

#include "radar_dot/common/stamped_twist.h"

namespace radar_dot {

/// What a source other than the twists says of the rotation over an interval.
struct KnownRotation {
  std::string source;  ///< for texts
  /// Of the base at both ends, in any one frame; none: the source does not know it, or not yet.
  std::optional<Eigen::Quaterniond> at_begin, at_end;
};

/// Motion of the base frame over an interval.
struct IntervalMotion {
  std::optional<Eigen::Isometry3d> T_begin_from_end;  ///< none: see `missing`
  std::string missing;
  bool without_rotation = false;  ///< the twists' own rates stand in for the source of rotation
};

/// The latest velocities of the vehicle, for its motion between two times.
class TwistHistory {
 public:
  /// @param duration  s that are kept   @param max_gap  s; nothing is interpolated across a longer one
  explicit TwistHistory(double duration = 10.0, double max_gap = 0.6)
      : duration_(duration), max_gap_(max_gap) {}

  /// What a twist does not observe although it has to.
  struct Lack {
    bool forward = false, yaw_rate = false;
    bool any() const { return forward || yaw_rate; }
  };
  /// Adds a twist onWheels(). One that lacks vx, or the yaw rate where that is needed, is left out: its
  /// neighbours stand in. So is one that is not later than all before.
  Lack add(const StampedTwist& twist, bool needs_yaw_rate = false);
  void clear() { twists_.clear(); }
  const StampedTwist* latest() const { return twists_.empty() ? nullptr : &twists_.back(); }

  /// Mean over the interval, without a covariance; linear between twists, constant before the first and after
  /// the last of them for up to `max_hold` s.
  /// @return none where they do not cover it, with the reason in `missing`
  std::optional<StampedTwist> mean(double begin, double end, double max_hold, std::string& missing) const;

  /// Pose of the base at `end`, in its frame at `begin`; `end` may be the earlier one.
  /// @param rotation  from a better source; null: there is none. Where it lacks an end, the twists' own rates
  ///                  stand in, or with `may_wait` nothing is known yet.
  IntervalMotion between(double begin, double end, double max_hold, const KnownRotation* rotation = nullptr,
                         bool may_wait = false) const;

 private:
  StampedTwist at(double time) const;

  double duration_, max_gap_;
  std::deque<StampedTwist> twists_;
};

}  // namespace radar_dot
