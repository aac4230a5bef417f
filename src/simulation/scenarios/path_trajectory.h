// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "radar_dot/simulation/trajectory.h"
#include "simulation/scenarios/path.h"
#include "simulation/scenarios/speed_profile.h"

namespace radar_dot::simulation {

/// Height of the ground changes by `step` m around a place of a path, smoothly: a kerb.
struct HeightStep {
  double along = 0.0;  ///< m
  double step = 0.0;   ///< m
};

/// A body that follows a path without slipping.
class PathTrajectory final : public Trajectory {
 public:
  struct Options {
    double start = 0.0;                    ///< m along the path at time 0
    double rear_axle_x = 0.0;              ///< m, of the point that follows the path, in the body frame
    double wheelbase = 0.0;                ///< m, for the steering angle; 0: not steered
    double height = 0.0;                   ///< m, of the ground at the path's start
    std::vector<HeightStep> height_steps;  ///< ordered
    double odometer = 0.0;                 ///< m, BodyState::distance at time 0: phase of gait and wheels
  };
  PathTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, Options options);

  BodyState at(double time_s) const override;
  const Path& path() const noexcept { return *path_; }
  const SpeedProfile& profile() const noexcept { return profile_; }
  /// m along the path.
  double along(double time_s) const noexcept { return options_.start + profile_.distance(time_s); }

 private:
  double heightAt(double along) const noexcept;

  std::shared_ptr<const Path> path_;
  SpeedProfile profile_;
  Options options_;
};

/// base_link of a car on springs: follows a path like PathTrajectory, and its body pitches and rolls
/// about base_link with its acceleration (a damped oscillator) and with the unevenness of the road
/// (sines of 1 to 2 Hz that fade with the speed), and heaves by millimetres.
class SprungTrajectory final : public Trajectory {
 public:
  struct Options {
    double pitch_per_acceleration = 0.0105;  ///< rad per m/s^2
    double roll_per_acceleration = 0.0105;   ///< rad per m/s^2
    double natural_frequency = 1.4;          ///< Hz
    double damping = 0.5;                    ///< of critical
    double pitch_deviation = 0.0022;         ///< rad rms, by the road
    double roll_deviation = 0.0018;          ///< rad rms
    double heave_deviation = 0.004;          ///< m rms
  };
  /// @param start m along the path at time 0.
  SprungTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, double start, std::uint64_t seed,
                   const Options& options);
  SprungTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, double start, std::uint64_t seed);

  BodyState at(double time_s) const override;
  const SpeedProfile& profile() const noexcept { return base_.profile(); }
  double along(double time_s) const noexcept { return base_.along(time_s); }

 private:
  struct Sine {
    double frequency = 0.0;  ///< rad/s
    double phase = 0.0;
  };
  struct Sway {
    double pitch = 0.0, roll = 0.0;
  };
  Sway response(double time_s) const noexcept;

  PathTrajectory base_;
  Options options_;
  std::vector<Sine> pitch_, roll_, heave_;
  std::vector<double> impulse_, impulse_slope_;  ///< response of the springs, by lag
};

}  // namespace radar_dot::simulation
