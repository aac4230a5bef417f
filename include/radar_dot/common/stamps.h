// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace radar_dot {

/// A stamp in s, to the bit as ros::Time::toSec() gives it: what runs live and what runs offline must not
/// differ in the last digit of their times.
inline double secondsOf(std::int64_t microseconds) {
  const std::int64_t seconds = microseconds / 1000000;
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(microseconds % 1000000 * 1000);
}

}  // namespace radar_dot
