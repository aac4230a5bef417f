// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_assembler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace radar_dot {

SweepAssembler::SweepAssembler(std::size_t radar_count, SweepParams params)
    : params_(params), pending_(radar_count), last_(radar_count) {}

void SweepAssembler::reset() {
  std::fill(pending_.begin(), pending_.end(), std::nullopt);
  std::fill(last_.begin(), last_.end(), std::nullopt);
  start_.reset();
  last_sweep_.reset();
}

bool SweepAssembler::isLive(std::size_t radar, double now) const {
  const double since = last_[radar] ? *last_[radar] : start_.value_or(now);
  return now - since <= params_.silent_after;
}

bool SweepAssembler::isComplete(double now) const {
  bool newer = false;
  for (std::size_t radar = 0; radar < pending_.size(); ++radar) {
    if (!pending_[radar] && isLive(radar, now)) return false;
    newer = newer || (pending_[radar] && (!last_sweep_ || pending_[radar]->time > *last_sweep_));
  }
  return newer;
}

std::optional<Sweep> SweepAssembler::take() {
  double newest = last_sweep_.value_or(-std::numeric_limits<double>::infinity());
  bool newer = false;
  for (const std::optional<SweepScan>& scan : pending_) {
    if (!scan || scan->time <= newest) continue;
    newest = scan->time;
    newer = true;
  }
  if (!newer) return std::nullopt;

  Sweep sweep;
  for (std::optional<SweepScan>& scan : pending_) {
    if (!scan) continue;
    if (newest - scan->time > params_.window) {
      ++sweep.left_out;
    } else {
      if (scan->time == newest) sweep.newest = sweep.scans.size();
      sweep.scans.push_back(std::move(*scan));
    }
    scan.reset();
  }
  last_sweep_ = newest;
  return sweep;
}

SweepAssembler::Outcome SweepAssembler::add(SweepScan scan, std::vector<Sweep>& completed) {
  completed.clear();
  Outcome outcome = Outcome::kAdded;
  const std::size_t radar = scan.radar;
  const double time = scan.time;
  // Each radar is compared with itself only: a small disorder between radars is normal.
  if (!std::isfinite(time)) return Outcome::kStale;
  if (last_[radar] && time <= *last_[radar]) {
    if (*last_[radar] - time <= params_.reset_after) return Outcome::kStale;
    reset();
    outcome = Outcome::kReset;
  }

  if (pending_[radar]) {
    if (std::optional<Sweep> sweep = take()) completed.push_back(std::move(*sweep));
  }
  if (!start_) start_ = time;
  last_[radar] = time;
  pending_[radar] = std::move(scan);
  if (isComplete(time)) {
    if (std::optional<Sweep> sweep = take()) completed.push_back(std::move(*sweep));
  }
  return outcome;
}

}  // namespace radar_dot
