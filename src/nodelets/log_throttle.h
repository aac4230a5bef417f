// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <map>
#include <string>

namespace radar_dot {

/// Lets one log line through per key and period. The macros of rosconsole throttle per line of
/// code, where one radar's complaint would hide another's.
class LogThrottle {
 public:
  explicit LogThrottle(double period = 5.0) : period_(period) {}

  /// True when nothing was let through for `key` within the period (wall time, s).
  bool allow(const std::string& key) {
    const ros::WallTime now = ros::WallTime::now();
    const auto [entry, fresh] = last_.try_emplace(key, now);
    if (!fresh && now - entry->second < ros::WallDuration(period_)) return false;
    entry->second = now;
    return true;
  }

 private:
  double period_;
  std::map<std::string, ros::WallTime> last_;
};

}  // namespace radar_dot
