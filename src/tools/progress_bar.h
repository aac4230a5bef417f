// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace radar_dot::tools {

/// One line on stderr with bar, rate and time left, redrawn a few times a second. It shows only
/// where stderr is a terminal and disappears at the end.
class ProgressBar {
 public:
  /// @param label    what is being done
  /// @param unit     what is counted, e.g. "readings"
  /// @param enabled  false = never show
  ProgressBar(std::string label, std::string unit, bool enabled = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::size_t done, std::size_t total);

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  std::string unit_;
  bool enabled_ = false;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point next_draw_;
};

}  // namespace radar_dot::tools
