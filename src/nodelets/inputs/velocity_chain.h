// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/radar/velocity_filter.h"

namespace radar_dot {

/// From the scans of a sweep to the velocity of the vehicle, and to the velocity filtered over the sweeps.
class VelocityChain {
 public:
  /// Replaces only the parts whose parameters differ: a filter that stays keeps what it has learnt of the
  /// mounts. @throws InvalidParameter, without any change
  void configure(const EgoVelocityConfig& config);

  /// rad, RadarScan::bearing_rotation of a scan, from the latest estimate. @param time  s, of the scan
  double bearingRotation(double time) const;
  /// @param time  s, of the newest scan
  /// @return valid until the next call
  const EgoVelocityResult& estimate(const std::vector<RadarScan>& scans, double time);

  struct Filtered {
    EgoVelocityResult velocity;
    bool was_reset = false;  ///< by a gap in the input, or by estimates outside the gate
  };
  bool filters() const noexcept { return filters_; }
  /// A valid estimate of these scans, filtered; none: it is not later than the one before.
  std::optional<Filtered> filtered(double time, const std::vector<RadarScan>& scans,
                                   const EgoVelocityResult& result);

  /// Forgets the past, what was learnt of the mounts as well.
  void reset();

  const EgoVelocityParams& params() const noexcept { return estimator_.params(); }
  const VelocityFilter& filter() const noexcept { return filter_; }

 private:
  EgoVelocityEstimator estimator_;
  AccelerationTracker tracker_;
  VelocityFilter filter_;
  bool filters_ = true;
  double bearing_delay_ = 0.0;           // s
  std::optional<StampedTwist> turning_;  // of the latest estimate
};

}  // namespace radar_dot
