// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace radar_dot::simulation {

/// Speed over time as knots joined by ramps v0 + (v1 - v0) (3 x^2 - 2 x^3): acceleration is continuous,
/// jerk is bounded, and the distance is an exact polynomial. Before the first and after the last knot
/// the speed stays as it is there.
class SpeedProfile {
 public:
  struct Knot {
    double time = 0.0;   ///< s
    double speed = 0.0;  ///< m/s, >= 0
  };

  /// @throws std::invalid_argument without knots, with times that do not grow, or a negative speed.
  explicit SpeedProfile(std::vector<Knot> knots);
  static SpeedProfile constant(double speed) { return SpeedProfile({{0.0, speed}}); }

  double speed(double time_s) const noexcept;         ///< m/s
  double acceleration(double time_s) const noexcept;  ///< m/s^2
  /// m, since time 0; negative before.
  double distance(double time_s) const noexcept;
  /// The same motion, begun `delay` s later.
  SpeedProfile delayed(double delay) const;
  const std::vector<Knot>& knots() const noexcept { return knots_; }

 private:
  double sinceFirstKnot(double time_s) const noexcept;

  std::vector<Knot> knots_;
  std::vector<double> travelled_;  ///< m, from the first knot to each
  double travelled_at_zero_ = 0.0;
};

/// Puts a profile together piece by piece.
class SpeedProfileBuilder {
 public:
  SpeedProfileBuilder(double time_s, double speed) : knots_{{time_s, speed}} {}

  /// Keeps the speed for `duration` s (nothing where it is not positive).
  SpeedProfileBuilder& keep(double duration);
  /// Keeps the speed over `distance` m; the speed must not be 0.
  SpeedProfileBuilder& keepFor(double distance);
  /// Changes to a speed within `duration` s; the way is duration (old + new) / 2.
  SpeedProfileBuilder& change(double speed, double duration);
  /// Comes to rest after exactly `distance` m, braking in the end over `braking` m.
  SpeedProfileBuilder& stopAfter(double distance, double braking);

  double time() const noexcept { return knots_.back().time; }
  double travelled() const noexcept { return travelled_; }  ///< m, since the beginning
  SpeedProfile build() const { return SpeedProfile(knots_); }

 private:
  std::vector<SpeedProfile::Knot> knots_;
  double travelled_ = 0.0;
};

}  // namespace radar_dot::simulation
