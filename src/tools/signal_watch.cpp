// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "signal_watch.h"

namespace radar_dot::tools {
namespace {

/// The signal that came last. A handler can reach nothing but a global; blocking the signals instead
/// would not do, because libraries start threads of their own, where they would still end the process.
volatile std::sig_atomic_t signal_received = 0;

}  // namespace

SignalWatch::SignalWatch() {
  struct sigaction action {};
  action.sa_handler = [](int number) { signal_received = number; };
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kWatched.size(); ++i) {
    sigaction(kWatched[i], &action, &before_[i]);
    // What whoever started the program chose to ignore (nohup) stays ignored.
    if (before_[i].sa_handler == SIG_IGN) sigaction(kWatched[i], &before_[i], nullptr);
  }
}

SignalWatch::~SignalWatch() {
  for (std::size_t i = 0; i < kWatched.size(); ++i) sigaction(kWatched[i], &before_[i], nullptr);
}

void SignalWatch::check() const {
  if (signal_received != 0) throw Interrupted(signal_received);
}

}  // namespace radar_dot::tools
