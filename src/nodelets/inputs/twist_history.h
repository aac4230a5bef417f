// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "radar_dot/radar/odometry.h"

namespace radar_dot {

/// A component of a twist with this variance or more is not observed, (m/s)^2 or (rad/s)^2.
inline constexpr double kUnobservedVariance = 1e5;

/// Why a twist cannot be used: another frame than the base frame, not finite. Empty when it can.
std::string twistDefect(const geometry_msgs::TwistWithCovarianceStamped& twist,
                        const std::string& base_frame);

/// Of a twist; a vertical motion (vz, wx, wy) that it does not observe is zero.
StampedVelocity velocityOf(const geometry_msgs::TwistWithCovarianceStamped& twist);

/// The latest velocities of the vehicle, for its motion between two times.
class TwistHistory {
 public:
  /// @param duration  s that are kept   @param max_gap  s; nothing is interpolated across a longer one
  explicit TwistHistory(double duration = 10.0, double max_gap = 0.6)
      : duration_(duration), max_gap_(max_gap) {}

  /// Later than all before; else it is left out.
  void add(const StampedVelocity& velocity);
  void clear() { velocities_.clear(); }
  const StampedVelocity* latest() const { return velocities_.empty() ? nullptr : &velocities_.back(); }

  /// Mean over the interval; linear between velocities, constant before the first and after the last of
  /// them for up to `max_hold` s.
  /// @return none where they do not cover it, with the reason in `missing`
  std::optional<StampedVelocity> mean(double begin, double end, double max_hold, std::string& missing) const;

  /// T_begin_from_end: pose of the base at `end`, in its frame at `begin`; `end` may be the earlier one.
  /// @param R_begin_from_end  rotation from a better source; none: that of the velocities
  std::optional<Eigen::Isometry3d> motion(double begin, double end, double max_hold, std::string& missing,
                                          const std::optional<Eigen::Matrix3d>& R_begin_from_end = {}) const;

 private:
  StampedVelocity at(double time) const;

  double duration_, max_gap_;
  std::deque<StampedVelocity> velocities_;
};

}  // namespace radar_dot
