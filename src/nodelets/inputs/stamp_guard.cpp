// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/stamp_guard.h"

namespace radar_dot {
namespace {

// So many old stamps in a row are no glitch any more.
constexpr int kRestartAfter = 5;

}  // namespace

// Differences of ros::Time throw beyond 2^31 s, which a wrong stamp can reach; those of toSec() do not.
bool isAhead(const ros::Time& stamp, const ros::Time& now) {
  return !now.isZero() && stamp.toSec() - now.toSec() > kTimeTolerance;
}

std::string stampDefect(const ros::Time& stamp, const ros::Time& now) {
  if (stamp.isZero()) return "its stamp is zero";
  if (isAhead(stamp, now)) return "its stamp is more than 1 s ahead of the clock; synchronise the clocks";
  return {};
}

bool ClockWatch::wentBack(const ros::Time& now) {
  const double time = now.toSec();
  const bool back = latest_ && time < *latest_ - kTimeTolerance;
  if (back || !latest_ || time > *latest_) latest_ = time;
  return back;
}

StampGuard::Verdict StampGuard::check(const ros::Time& stamp) {
  const double time = stamp.toSec();
  Verdict verdict = Verdict::kGood;
  if (last_ && time <= *last_) {
    // A stamp that stands still is no restart: that would go on.
    const bool goes_on = older_ == 0 || time > candidate_;
    older_ = *last_ - time <= kTimeTolerance ? 0 : goes_on ? older_ + 1 : 1;
    candidate_ = time;
    if (older_ < kRestartAfter) return Verdict::kStale;
    verdict = Verdict::kRestart;
  }
  older_ = 0;
  last_ = time;
  return verdict;
}

void StampGuard::reset() {
  last_.reset();
  older_ = 0;
}

}  // namespace radar_dot
