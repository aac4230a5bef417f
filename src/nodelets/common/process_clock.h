// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/time.h>

#include <functional>
#include <memory>
#include <vector>

namespace radar_dot {

/// The clock of what waits, repeats or is throttled in this process: the wall clock. Where a recording is
/// processed without regard to real time it is the time of the recording, which stands still while something
/// is computed: the same recording gives the same result on every machine.
class ProcessClock {
 public:
  static ros::WallTime now();

  /// From now on this clock and that of ROS show the time of a recording. Before the first nodelet.
  static void follow(const ros::Time& start);
  static bool isRecorded();
  /// Lets the time of the recording pass, and calls the timers that are due in their order, `after_each`
  /// after each of them.
  static void advanceTo(const ros::Time& time, const std::function<void()>& after_each);
};

/// A timer by the clock of the process. Its callback comes through the queue of the handle, except in a
/// recording, where advanceTo() calls it.
class ProcessTimer {
 public:
  enum class Kind { kRepeating, kOnce };  ///< kOnce: runs after each start(), and not before the first

  ProcessTimer() = default;
  /// @param period  s
  ProcessTimer(const ros::NodeHandle& handle, double period, std::function<void()> callback,
               Kind kind = Kind::kRepeating);

  void stop();
  /// Calls back in `period` s from now, without regard to an earlier start.
  void restart(double period);

 private:
  struct Recorded;
  friend class ProcessClock;
  static std::vector<std::weak_ptr<Recorded>>& recorded();

  ros::WallTimer wall_;
  std::shared_ptr<Recorded> recorded_;
};

}  // namespace radar_dot
