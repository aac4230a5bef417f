// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <iterator>
#include <map>
#include <string>

#include "nodelets/common/process_clock.h"

namespace radar_dot {

/// Lets one log line through per subject, kind and period. The macros of rosconsole throttle per
/// line of code, where one radar's complaint would hide another's.
class LogThrottle {
 public:
  explicit LogThrottle(double period = 5.0) : period_(period) {}

  /// True when nothing of this kind was let through for `subject` within the period (wall time, s).
  /// The kind is `text` without its figures and quoted names: these come from messages and vary.
  bool allow(const std::string& subject, const std::string& text) {
    const ros::WallTime now = ProcessClock::now();
    if (last_.size() >= kPruneAt) prune(now);
    const auto [entry, fresh] = last_.try_emplace(subject + '\n' + kindOf(text), now);
    if (!fresh && now - entry->second < period_) return false;
    entry->second = now;
    return true;
  }

  std::size_t size() const noexcept { return last_.size(); }

 private:
  static constexpr std::size_t kPruneAt = 100;

  static std::string kindOf(const std::string& text) {
    std::string kind;
    bool quoted = false;
    for (const char c : text) {
      if (c == '\'') quoted = !quoted;
      if (!quoted && (c < '0' || c > '9')) kind += c;
    }
    return kind;
  }

  void prune(const ros::WallTime& now) {
    for (auto entry = last_.begin(); entry != last_.end();) {
      entry = now - entry->second < period_ ? std::next(entry) : last_.erase(entry);
    }
  }

  ros::WallDuration period_;
  std::map<std::string, ros::WallTime> last_;
};

}  // namespace radar_dot
