// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include "nodelets/common/process_clock.h"

namespace radar_dot {

/// A moment on both clocks, s. What waits counts both: the data it waits for come by the clock of ROS, which
/// is slow in a slow replay; what is computed of them takes its time by the wall clock, in a fast one as
/// well.
struct Moment {
  double ros = 0.0, wall = 0.0;

  /// A clock of ROS that stands still (a bag that is paused or over) must hold nothing back forever: no wait
  /// is longer than this many times its timeout in wall time. A replay can be slower by this factor.
  static constexpr double kSlowest = 20.0;

  static Moment now() { return {ros::Time::now().toSec(), ProcessClock::now().toSec()}; }

  /// True while what arrived at this moment still waits.
  bool waits(double timeout, const Moment& now) const {
    const double waited = now.wall - wall;
    return (now.ros - ros < timeout || waited < timeout) && waited < kSlowest * timeout;
  }
};

}  // namespace radar_dot
