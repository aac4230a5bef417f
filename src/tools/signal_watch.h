// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <csignal>
#include <stdexcept>

namespace radar_dot::tools {

/// What a shell reports for a program ended by a signal, less the signal's number.
inline constexpr int kSignalBase = 128;

/// A signal asked the program to end.
struct Interrupted : std::runtime_error {
  explicit Interrupted(int number) : std::runtime_error("interrupted"), signal(number) {}
  int signal;
};

/// Only notes SIGINT, SIGTERM and SIGHUP while it lives, so that work can be ended where it cleans up
/// after itself.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// @throws Interrupted when one of the signals has come.
  void check() const;

 private:
  static constexpr std::array<int, 3> kWatched = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_{};
};

}  // namespace radar_dot::tools
