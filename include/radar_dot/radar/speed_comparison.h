// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

namespace radar_dot {

/// Compares the forward velocity by the radars with an independent one, of an odometry or of TF, over the
/// last seconds. They contradict each other where the mean of their difference stays large.
class SpeedComparison {
 public:
  enum class Verdict {
    kAgree,
    kStands,           ///< by the radars the vehicle stands, and it drives
    kReferenceStands,  ///< the other way round
    kOpposite,         ///< the same with the other sign
    kFactor,           ///< anything else
  };

  /// Readings in the order of time; after a step back or a gap of more than 2 s the past is forgotten.
  /// @param time  s   @param speed, reference  m/s: the one under test, and the independent one
  void add(double time, double speed, double reference);
  void reset() { *this = SpeedComparison(); }
  /// Forgets the past after a gap of more than 2 s up to `time`: where there are no readings any more.
  void expire(double time);

  Verdict verdict() const noexcept { return verdict_; }
  // Means over about the last 3 s, m/s.
  double speed() const { return mean(speed_); }
  double reference() const { return mean(reference_); }

  /// "ego/twist drives at 0.0 m/s, TF at 15.0 (over 3 s): ..." with the likely cause; empty while they agree.
  /// @param name, reference_name  as in the example
  /// @param rates  what the range rates are called, as in "the range rates (field 'v' of front)"
  std::string warning(const std::string& name, const std::string& reference_name,
                      const std::string& rates) const;

 private:
  double mean(double sum) const { return weight_ > 0.0 ? sum / weight_ : 0.0; }
  Verdict cause() const;

  double time_ = -std::numeric_limits<double>::infinity();
  double weight_ = 0.0, speed_ = 0.0, reference_ = 0.0, difference_ = 0.0;
  Verdict verdict_ = Verdict::kAgree;
};

}  // namespace radar_dot
