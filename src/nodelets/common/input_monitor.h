// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <string>
#include <utility>

#include "nodelets/common/monitors.h"
#include "nodelets/inputs/stamp_guard.h"

namespace radar_dot {

/// Checks that hold for every stamped message: frame given, stamp given and not ahead of the clock.
/// @throws std::invalid_argument saying what is wrong
void checkHeader(const std_msgs::Header& header, const ros::Time& now);

/// One input of a nodelet: its order of stamps, its health, and what was refused of it.
class InputMonitor {
 public:
  /// @param name      for logs and diagnostics, as in "depth"
  /// @param required  false: its silence is no error
  InputMonitor(std::string name, StreamExpectation expectation, bool required)
      : name_(std::move(name)), required_(required), stream_(expectation) {}

  const std::string& name() const noexcept { return name_; }
  /// Resolved name, once subscribed; empty: not subscribed now.
  const std::string& topic() const noexcept { return topic_; }
  void setTopic(std::string topic) { topic_ = std::move(topic); }

  /// @param max_age  s between stamp and arrival, above which the report warns
  void expectMaxAge(double max_age) { stream_.expectMaxAge(max_age); }

  /// Takes a message into the order. @return false when time restarted with it: everything from before is
  /// to be forgotten. @throws std::invalid_argument as checkHeader(), and for a stamp not after the one
  /// before.
  bool accept(const std_msgs::Header& header, const ros::Time& now);
  /// The same for messages that several sources send on one topic, in no order.
  void acceptUnordered(const std_msgs::Header& header, const ros::Time& now);
  /// What holds until the next one comes, as a calibration: any stamp, and silence is no error afterwards.
  void acceptLatched(const ros::Time& now);
  /// The latest message cannot be used, whether it was accepted or not.
  void refuse(const std::string& cause);
  void reset();

  /// Reports, and starts the next interval.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  std::string name_, topic_;
  bool required_;
  StreamMonitor stream_;
  StampGuard stamps_;
  std::string cause_;
  bool latest_is_good_ = false;
  bool lasts_ = false;
  std::size_t good_ = 0;     // since the last report
  std::size_t refused_ = 0;  // since the last report
  std::size_t refused_in_all_ = 0;
};

}  // namespace radar_dot
