// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
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

/// Scans of one radar that went into no sweep.
struct SweepLosses {
  std::size_t outside_window = 0;  ///< older than the window when their sweep was complete
  std::size_t late = 0;            ///< came after a later sweep, and before one that could take them
  std::size_t stale = 0;           ///< not finite, or not newer than the radar's previous scan
  std::size_t forgotten = 0;       ///< waited when everything was reset
};

/// Decides which scans of several unsynchronised radars are estimated together, by their stamps.
///
/// A sweep is complete when every live radar has delivered a scan since the last sweep, or when a
/// radar delivers a second one while others are missing. A radar is live until it has been silent
/// for `silent_after`, at the beginning as well as later, or for one and a half intervals of the quickest
/// radar, if that is longer, as where all are slow. Every sweep is newer than the one before.
///
/// Scans that arrive in the order of their stamps are used at once. Where radars have overtaken each other, a
/// scan is held back while another live radar may still deliver an earlier one: when its shortest interval
/// has passed since its latest scan, and for no longer than the largest delay among the radars (in stamps, at
/// most `silent_after`). Delays and intervals are those of the last half minute to minute. So from the first
/// delay of some size on, the sweeps do not depend on the order of arrival up to that size. A radar that is
/// always later than the window is not waited for.
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
      : params_(params), radars_(radar_count), losses_(radar_count) {}

  /// Adds a scan. `completed` is replaced by the sweeps it completes, in order of time. Where scans arrive in
  /// order there are none, one, or two (the one before a second scan, and the one that scan completes
  /// itself).
  Outcome add(Scan scan, std::vector<Sweep>& completed) {
    completed.clear();
    Outcome outcome = Outcome::kAdded;
    // Each radar is compared with itself only: a small disorder between radars is normal.
    const std::optional<double> previous = radars_[scan.radar].latest;
    if (!std::isfinite(scan.time) ||
        (previous && scan.time <= *previous && *previous - scan.time <= params_.reset_after)) {
      ++losses_[scan.radar].stale;
      return Outcome::kStale;
    }
    if (previous && scan.time <= *previous) {
      reset();
      outcome = Outcome::kReset;
    }
    if (!start_) start_ = newest_ = period_start_ = scan.time;
    newest_ = std::max(newest_, scan.time);
    if (newest_ - period_start_ > kMemory) startPeriod();
    const double delay = newest_ - scan.time;
    disorder_ = std::min(std::max(disorder_, delay), params_.silent_after);
    Radar& radar = radars_[scan.radar];
    const double interval = radar.latest ? scan.time - *radar.latest : kNever;
    radar.shortest = std::min(radar.shortest, interval);
    radar.delay = std::min(delay, radar.delay + kForgetting * interval);
    radar.latest = scan.time;

    arrived_.insert(std::upper_bound(arrived_.begin(), arrived_.end(), scan, isEarlier), std::move(scan));
    while (!arrived_.empty() && isNext(arrived_.front().time)) {
      use(std::move(arrived_.front()), completed);
      arrived_.pop_front();
    }
    return outcome;
  }

  /// By radar, since the beginning: a reset does not forget them. Only scans that still wait, at most those
  /// of `silent_after`, are neither in a sweep nor here.
  const std::vector<SweepLosses>& losses() const noexcept { return losses_; }

  /// Forgets every scan and which radars live.
  void reset() {
    SweepAssembler fresh(radars_.size(), params_);
    for (const Scan& scan : arrived_) ++losses_[scan.radar].forgotten;
    for (std::size_t i = 0; i < radars_.size(); ++i) losses_[i].forgotten += radars_[i].pending ? 1 : 0;
    std::swap(fresh.losses_, losses_);
    *this = std::move(fresh);
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr double kForgetting = 0.1;  // s/s, of the least delay of a radar
  static constexpr double kUsual = 1.5;       // intervals between two scans of a radar
  // s, for which delays and intervals are remembered, and up to twice that: a hiccup holds up nothing for
  // ever.
  static constexpr double kMemory = 30.0;

  struct Radar {
    std::optional<double> latest;     ///< s, stamp of the latest scan that arrived
    std::optional<double> used;       ///< s, stamp of the latest scan that was used
    double shortest = kNever;         ///< s between two scans, in this period
    double shortest_before = kNever;  ///< s, in the one before
    double shortestInterval() const { return std::min(shortest, shortest_before); }
    double delay = 0.0;           ///< s behind the newest stamp at arrival, the least of late
    std::optional<Scan> pending;  ///< in the sweep that is to be completed
  };

  static bool isEarlier(const Scan& a, const Scan& b) {
    return a.time < b.time || (a.time == b.time && a.radar < b.radar);
  }

  void startPeriod() {
    period_start_ = newest_;
    disorder_before_ = std::exchange(disorder_, 0.0);
    for (Radar& radar : radars_) radar.shortest_before = std::exchange(radar.shortest, kNever);
  }

  bool isLive(const std::optional<double>& last, double now) const {
    double interval = kNever;
    for (const Radar& radar : radars_) interval = std::min(interval, radar.shortestInterval());
    const double usual = std::isfinite(interval) ? kUsual * interval : 0.0;
    return now - last.value_or(*start_) <= std::max(params_.silent_after, usual);
  }

  /// Will no radar deliver a scan before `time` any more?
  bool isNext(double time) const {
    if (newest_ - std::max(disorder_, disorder_before_) >= time) return true;
    return std::none_of(radars_.begin(), radars_.end(), [&](const Radar& radar) {
      const bool is_due = !radar.latest || *radar.latest + radar.shortestInterval() < time;
      return is_due && isLive(radar.latest, time) && radar.delay <= params_.window;
    });
  }

  /// Scans come here in the order of their stamps, as far as isNext() knows.
  void use(Scan scan, std::vector<Sweep>& completed) {
    Radar& radar = radars_[scan.radar];
    const double now = scan.time;
    if (radar.pending) take(completed);
    if (radar.pending) ++losses_[scan.radar].late;  // all that wait are older than the sweep before
    radar.used = now;
    radar.pending = std::move(scan);
    const bool is_complete = std::all_of(radars_.begin(), radars_.end(), [&](const Radar& other) {
      return other.pending || !isLive(other.used, now);
    });
    if (is_complete) take(completed);
  }

  /// The waiting scans as a sweep, unless none is newer than the one before.
  void take(std::vector<Sweep>& completed) {
    double newest = last_sweep_;
    for (const Radar& radar : radars_)
      if (radar.pending) newest = std::max(newest, radar.pending->time);
    if (!(newest > last_sweep_)) return;

    Sweep& sweep = completed.emplace_back();
    for (Radar& radar : radars_) {
      if (!radar.pending) continue;
      if (newest - radar.pending->time > params_.window) {
        ++sweep.left_out;
        ++losses_[radar.pending->radar].outside_window;
      } else {
        if (radar.pending->time == newest) sweep.newest = sweep.scans.size();
        sweep.scans.push_back(std::move(*radar.pending));
      }
      radar.pending.reset();
    }
    last_sweep_ = newest;
  }

  SweepParams params_;
  std::vector<Radar> radars_;
  std::vector<SweepLosses> losses_;  ///< by radar
  std::deque<Scan> arrived_;         ///< not used yet, in order of time
  std::optional<double> start_;      ///< stamp of the scan that came first
  double newest_ = 0.0;              ///< latest stamp that arrived
  double disorder_ = 0.0;            ///< s, largest delay behind newest_, in this period
  double disorder_before_ = 0.0;     ///< s, in the one before
  double period_start_ = 0.0;        ///< s
  double last_sweep_ = -kNever;      ///< time of the latest sweep
};

}  // namespace radar_dot
