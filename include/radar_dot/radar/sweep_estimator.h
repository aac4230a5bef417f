// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/radar/doppler_unwrapping.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/radar/velocity_filter.h"

namespace radar_dot {

/// Parameters of SweepEstimator, described where they are configured.
struct SweepEstimatorParams {
  double bearing_delay = 0.0;  ///< s, by which positions of returns are later than their velocities
  EgoVelocityParams estimator;
  bool filter = true;         ///< of a vehicle in the plane: not with the spatial model
  bool filter_radars = true;  ///< it takes the velocity of each radar alone; else the joint estimates
  VelocityFilterParams filter_params;
};

/// By what a mount is turned from its calibration.
struct MountYaw {
  double yaw = 0.0;  ///< rad, to be added to the yaw of the mount
  double std = 0.0;  ///< rad
};

/// What is known after a sweep.
struct SweepEstimate {
  struct Filtered {
    VelocityFilter::State state;      ///< at the time of the sweep
    VelocityFilter::Outcome outcome;  ///< what became of the estimate in the filter
    bool was_reset;                   ///< by a gap in the input, or by estimates outside the gate
  };
  EgoVelocityResult single;  ///< of this sweep alone, with residuals and labels of its scans
  /// Over the sweeps: none without the filter, without a valid estimate, or where that is not later than the
  /// one before.
  std::optional<Filtered> filtered;
  bool filters = true;          ///< the filter is on, and the model one of a motion in the plane
  std::string assumption = {};  ///< one line where `single` rests on one: DopplerUnwrapping::assumption

  /// What ego/twist says of the sweep: filtered, or of the sweep alone where the filter is off; none as for
  /// `filtered`, or without a valid estimate.
  std::optional<EgoVelocityResult> output() const;
};

/// From the scans of each sweep to the velocity of the vehicle, and to the velocity filtered over the sweeps:
/// the same for a vehicle and for a recording. Sweeps come in the order of time; returns that are known to
/// move are marked by the caller (RadarScan::known_dynamic).
class SweepEstimator {
 public:
  /// @throws InvalidParameter
  explicit SweepEstimator(const SweepEstimatorParams& params = {}) { configure(params); }

  /// Replaces only the parts whose parameters differ: a filter that stays keeps what it has learnt of the
  /// mounts. @throws InvalidParameter, without any change
  void configure(const SweepEstimatorParams& params);

  /// Mounts whose yaws are known from earlier, by radar. A sigma below 1 mrad counts as 1 mrad, so that the
  /// filter can still learn. Resets; they hold after every later reset too.
  void startFrom(std::vector<std::optional<MountYaw>> mounts);

  /// Turns the mounts of the scans by what startFrom() says, and the bearings, unwraps their range rates
  /// where those are ambiguous (the returns of `scans` then stay here until the next call), and estimates.
  /// @param time   s, of the newest scan
  /// @param known  the angular velocity then, where another source tells it: then a single radar away from
  ///               the origin tells the velocity of the origin
  SweepEstimate estimate(std::vector<RadarScan>& scans, double time,
                         const std::optional<AngularVelocity>& known = std::nullopt);

  /// What the sweeps so far say of other scans: sets their bearing_rotation by the latest yaw rate.
  void turnBearings(std::vector<RadarScan>& scans) const;
  /// m/s^2, base frame; zero where it is not known.
  Eigen::Vector3d acceleration(double time) const { return tracker_.acceleration(time); }

  /// What the mount is turned by, with what the filter has learnt since the start.
  MountYaw mountYaw(std::size_t radar) const;
  /// Is the filter surer of it than at the start?
  bool hasLearnt(std::size_t radar) const;

  /// Forgets the past, what was learnt of the mounts as well.
  void reset();

  const EgoVelocityParams& params() const noexcept { return estimator_.params(); }
  const VelocityFilter& filter() const noexcept { return filter_; }

 private:
  /// The velocity at the latest sweep: of that alone, which follows any jerk, or, where it lacks vx, of the
  /// filter.
  std::optional<StampedTwist> latestVelocity() const;
  std::vector<std::optional<double>> startStds() const;

  EgoVelocityEstimator estimator_;
  DopplerUnwrapping unwrapping_;
  AccelerationTracker tracker_;
  VelocityFilter filter_;
  std::vector<std::optional<MountYaw>> start_;  // by radar
  bool filters_ = true, filters_radars_ = true;
  double bearing_delay_ = 0.0;           // s
  std::optional<StampedTwist> latest_;   // valid estimate
  std::optional<StampedTwist> turning_;  // the same, or the angular velocity of another source alone
};

}  // namespace radar_dot
