// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <optional>
#include <string>

namespace radar_dot {

/// s. A step back of more is a restart of time; a stamp further ahead of the clock is an error of
/// some clock, not of transport.
constexpr double kTimeTolerance = 1.0;

/// True when the stamp lies more than kTimeTolerance ahead of the clock. A clock at zero says nothing.
bool isAhead(const ros::Time& stamp, const ros::Time& now);

/// Why a stamp cannot be used: zero, or ahead of the clock. Empty when it can.
std::string stampDefect(const ros::Time& stamp, const ros::Time& now);

/// Sees the ROS clock itself go back, as it does when a bag starts again.
class ClockWatch {
 public:
  /// Called with the clock at every message. @return true once per step back.
  bool wentBack(const ros::Time& now);

 private:
  std::optional<double> latest_;  // s
};

/// Tells the stamps of one stream that go on from those that are late, and from a restart that no
/// clock shows (a bag that starts again without --clock).
class StampGuard {
 public:
  enum class Verdict {
    kGood,
    kStale,    ///< not later than the one before: to be left out
    kRestart,  ///< the last few rose, older by more than kTimeTolerance: this is the new time
  };
  Verdict check(const ros::Time& stamp);
  void reset();

 private:
  std::optional<double> last_;  // s
  int older_ = 0;               // consecutive, rising stamps that were much older than last_
  double candidate_ = 0.0;      // s, the latest of them
};

}  // namespace radar_dot
