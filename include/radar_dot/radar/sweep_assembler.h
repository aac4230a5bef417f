// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// Parameters of SweepAssembler.
struct SweepParams {
  double window = 0.1;
  double silent_after = 0.5;
  double reset_after = 1.0;  ///< s, a step back in a radar's stamps that resets everything

  void describe(FieldList& fields) {
    fields.add("window", window, "Age of the oldest scan of a sweep relative to its newest", "s",
               {0.001, 10.0});
    describeSilentAfter(silent_after, fields);
  }
  static void describeSilentAfter(double& silent_after, FieldList& fields) {
    fields.add("silent_after", silent_after,
               "Time without a message after which a sensor or topic counts as silent and is not waited for",
               "s", {0.001, 3600.0});
  }
};

/// Decides which scans of several unsynchronised radars are estimated together.
///
/// A sweep is complete when every live radar has delivered a scan since the last sweep, or when a
/// radar delivers a second one while others are missing. A radar is live until it has been silent
/// for `silent_after`, at the beginning as well as later. Every sweep is newer than the one before.
///
/// @tparam Reading  what a radar measured, or a pointer to it; only passed through
template <typename Reading>
class SweepAssembler {
 public:
  /// One scan waiting for its sweep.
  struct Scan {
    std::size_t radar = 0;  ///< index of the radar
    double time = 0.0;      ///< s, stamp of the scan
    Reading reading;
  };

  /// The scans that make one estimate, at most one per radar, each within the window.
  struct Sweep {
    std::vector<Scan> scans;   ///< in order of the radars
    std::size_t newest = 0;    ///< index in `scans` of the scan with the latest stamp
    std::size_t left_out = 0;  ///< scans older than the window, not in `scans`
    double time() const { return scans[newest].time; }
  };

  /// What became of a scan.
  enum class Outcome {
    kAdded,
    kStale,  ///< not finite, or not newer than the radar's previous scan: left out
    kReset,  ///< time went back: all earlier scans are forgotten, this one is added
  };

  explicit SweepAssembler(std::size_t radar_count, const SweepParams& params = {})
      : params_(params), pending_(radar_count), last_(radar_count) {}

  /// Adds a scan. `completed` is replaced by the sweeps it completes: none, one, or two (the
  /// one before a second scan, and the one that scan completes itself).
  Outcome add(Scan scan, std::vector<Sweep>& completed) {
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

    if (pending_[radar]) take(completed);
    if (!start_) start_ = time;
    last_[radar] = time;
    pending_[radar] = std::move(scan);
    if (isComplete(time)) take(completed);
    return outcome;
  }

  /// Forgets every scan and which radars live.
  void reset() { *this = SweepAssembler(pending_.size(), params_); }

 private:
  bool isLive(std::size_t radar, double now) const {
    const double since = last_[radar] ? *last_[radar] : start_.value_or(now);
    return now - since <= params_.silent_after;
  }

  bool isComplete(double now) const {
    for (std::size_t radar = 0; radar < pending_.size(); ++radar)
      if (!pending_[radar] && isLive(radar, now)) return false;
    return true;
  }

  /// The waiting scans as a sweep, unless none is newer than the one before.
  void take(std::vector<Sweep>& completed) {
    double newest = last_sweep_;
    for (const std::optional<Scan>& scan : pending_)
      if (scan) newest = std::max(newest, scan->time);
    if (!(newest > last_sweep_)) return;

    Sweep& sweep = completed.emplace_back();
    for (std::optional<Scan>& scan : pending_) {
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
  }

  SweepParams params_;
  std::vector<std::optional<Scan>> pending_;                      ///< by radar
  std::vector<std::optional<double>> last_;                       ///< by radar: stamp of its latest scan
  std::optional<double> start_;                                   ///< stamp of the very first scan
  double last_sweep_ = -std::numeric_limits<double>::infinity();  ///< time of the latest sweep
};

}  // namespace radar_dot
