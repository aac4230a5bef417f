// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
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

/// One scan waiting for its sweep.
struct SweepScan {
  std::size_t radar = 0;  ///< index of the radar
  double time = 0.0;      ///< s, stamp of the scan
  std::shared_ptr<const void>
      reading;  ///< what the radar measured, of the caller's own type; only passed through
};

/// The scans that make one estimate, at most one per radar, each within the window.
struct Sweep {
  std::vector<SweepScan> scans;  ///< in order of the radars
  std::size_t newest = 0;        ///< index in `scans` of the scan with the latest stamp
  std::size_t left_out = 0;      ///< scans older than the window, not in `scans`
  double time() const { return scans[newest].time; }
};

/// Decides which scans of several unsynchronised radars are estimated together.
///
/// A sweep is complete when every live radar has delivered a scan since the last sweep, or when a
/// radar delivers a second one while others are missing. A radar is live until it has been silent
/// for `silent_after`, at the beginning as well as later. Every sweep is newer than the one before.
class SweepAssembler {
 public:
  /// What became of a scan.
  enum class Outcome {
    kAdded,
    kStale,  ///< not finite, or not newer than the radar's previous scan: left out
    kReset,  ///< time went back: all earlier scans are forgotten, this one is added
  };

  explicit SweepAssembler(std::size_t radar_count, SweepParams params = {});

  /// Adds a scan. `completed` is replaced by the sweeps it completes: none, one, or two (the
  /// one before a second scan, and the one that scan completes itself).
  Outcome add(SweepScan scan, std::vector<Sweep>& completed);

  /// Forgets every scan and which radars live.
  void reset();

 private:
  bool isLive(std::size_t radar, double now) const;
  bool isComplete(double now) const;
  std::optional<Sweep> take();

  SweepParams params_;
  std::vector<std::optional<SweepScan>> pending_;  ///< by radar
  std::vector<std::optional<double>> last_;        ///< by radar: stamp of its latest scan
  std::optional<double> start_;                    ///< stamp of the very first scan
  std::optional<double> last_sweep_;               ///< time of the latest sweep
};

}  // namespace radar_dot
