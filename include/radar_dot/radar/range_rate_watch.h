// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "radar_dot/common/span.h"
#include "radar_dot/radar/doppler_returns.h"

namespace radar_dot {

/// Tells from the returns of one radar alone that its velocities are no range rates.
///
/// One velocity of all returns is none: that of a rigid scene falls with the cosine of the bearing. And where
/// nearly all returns say that they neither come nor go, they must be seen again where they were: the watch
/// looks how many of them are, and how many are where a vehicle that drives ahead would see them. Compensated
/// and empty velocities show so, where the surroundings have something to hold on to.
class RangeRateWatch {
 public:
  enum class Verdict {
    kGood,      ///< or not known
    kConstant,  ///< one velocity of all returns
    kStill,     ///< none, while the returns come nearer
  };

  /// A scan, in the order of time (s); after a step back everything is forgotten.
  void add(double time, Span<const DopplerReturn> returns, const Eigen::Isometry3d& T_base_from_sensor);
  void reset() { *this = RangeRateWatch(); }

  Verdict verdict() const noexcept { return verdict_; }
  /// m/s: the one velocity, or the speed by which the returns come nearer.
  double value() const noexcept { return value_; }
  /// What is wrong, and the likely cause; empty for kGood. @param source  "field 'vr'"
  std::string warning(const std::string& source) const;

 private:
  static constexpr std::size_t kSpeeds = 36;  // m/s, whole ones from zero

  using Points = std::vector<Eigen::Vector2d>;
  static bool isConstant(Span<const DopplerReturn> returns);
  void look(double dt, const Points& points, const Eigen::Vector2d& mount);
  void judge(double dt);

  double time_ = -std::numeric_limits<double>::infinity();  // s, of the latest scan
  double constant_for_ = 0.0, still_for_ = 0.0;             // s
  double constant_ = 0.0;                                   // m/s
  double seen_ = -std::numeric_limits<double>::infinity();  // s, of `points_`
  Points points_;                                           // m, base frame, those that say they are still
  double looks_ = 0.0;                                      // weight of `found_`
  std::array<double, kSpeeds> found_{};  // fraction of the points that is seen again, by speed
  Verdict verdict_ = Verdict::kGood;
  double value_ = 0.0;
};

}  // namespace radar_dot
