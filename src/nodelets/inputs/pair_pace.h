// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace radar_dot {

/// Of how many images one makes a pair: of each, or where pairs are lost as they take longer than until the
/// next image comes, of every second, third or fourth, so that they come evenly. They reach from one such
/// image to the next.
class PairPace {
 public:
  static constexpr int kSlowest = 4;

  /// An image has come. @param stamp, now  s, of its header and of the clock of the process
  void addImage(double stamp, double now);
  /// A pair has come in the place of one that still waited.
  void addLost() { lost_ += 1.0; }
  /// A pair has been computed.
  /// @param interval  s, between its images
  /// @param seconds   that it took
  void addPair(double interval, double seconds, double now);

  /// @param asked    s, least interval of a pair that is asked for; 0: consecutive images
  /// @param longest  s, longest one that is allowed: no reason for none at all
  int every(double asked, double longest) const;
  /// s, between the two images of a pair.
  double leastInterval(double asked, double longest) const;
  /// Part of the time between two pairs that one takes.
  double load() const noexcept { return load_; }

 private:
  int every_ = 1;
  int images_ = 0;
  double stamp_ = 0.0, now_ = 0.0;             // s, of the latest image
  double period_ = 0.0, wall_period_ = 0.0;    // s, of the images
  double load_ = 0.0, lost_ = 0.0;             // of late
  double easy_since_ = 0.0, quickened_ = 0.0;  // s; from when on a quicker pace would do, and the latest try
  double patience_ = 0.0;                      // s, until it is tried
};

}  // namespace radar_dot
