// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

namespace radar_dot {

/// Compares a yaw rate with an independent one, of an IMU or of the image, over the last seconds.
///
/// They contradict each other where their difference, smoothed so that a delay between them does not count,
/// stays large: in absolute terms, against its own uncertainty, and against the rate itself.
class YawRateComparison {
 public:
  enum class Verdict {
    kAgree,
    kOpposite,  ///< the same with the other sign
    kDegrees,   ///< one of the two is in degrees per second
    kFactor,    ///< they differ in proportion to the rate
    kOffset,    ///< they differ whatever the rate
  };

  /// Readings in the order of time; after a step back or a gap of more than 2 s the past is forgotten.
  /// @param time       s
  /// @param rate       rad/s, the one under test
  /// @param std        rad/s, 1 sigma of the difference of the two
  /// @param reference  rad/s, the independent one
  void add(double time, double rate, double std, double reference);
  void reset() { *this = YawRateComparison(); }
  /// Forgets the past after a gap of more than 2 s up to `time`: where there are no readings any more.
  void expire(double time);

  Verdict verdict() const noexcept { return verdict_; }
  // Means over about the last 3 s, rad/s.
  double rate() const { return mean(rate_); }
  double reference() const { return mean(reference_); }
  double difference() const { return mean(difference_); }  ///< absolute, smoothed

  /// "ego/twist turns by 0.08 rad/s, the image by 0.28 (over 3 s): ..." with the likely cause; empty while
  /// they agree. @param name, reference_name  as in the example
  /// @param remedy  where they differ by a factor, and neither sign nor unit explains it
  std::string warning(const std::string& name, const std::string& reference_name,
                      const char* remedy =
                          "the yaw rate of the radars is wrong: take it from an IMU, odometry or TF "
                          "(rotation_source), or check the position of the mounts and the model") const;

 private:
  double mean(double sum) const { return weight_ > 0.0 ? sum / weight_ : 0.0; }
  Verdict cause() const;

  double time_ = -std::numeric_limits<double>::infinity();
  double smooth_ = 0.0;  // rad/s, the difference
  double weight_ = 0.0, rate_ = 0.0, reference_ = 0.0, difference_ = 0.0, variance_ = 0.0, size_ = 0.0;
  // Sums over a longer time, for the cause: squares and product, and the signed difference.
  double long_weight_ = 0.0, aa_ = 0.0, ab_ = 0.0, bb_ = 0.0, signed_ = 0.0;
  Verdict verdict_ = Verdict::kAgree;
};

}  // namespace radar_dot
