// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

#include <deque>
#include <string>

#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// What is expected of a stream of stamped messages.
struct StreamExpectation {
  double rate = 13.0;           ///< Hz; 0: any
  double rate_tolerance = 0.3;  ///< share of the rate
  double max_age = 0.5;         ///< s between the stamp and the arrival, either way
  double silent_after = 0.5;    ///< s without a message
};

/// Rate and age of a stream of stamped messages.
class StreamMonitor {
 public:
  explicit StreamMonitor(StreamExpectation expectation = {}) : expectation_(expectation) {}

  /// @param max_age  s between stamp and arrival
  void expectMaxAge(double max_age) { expectation_.max_age = max_age; }
  void tick(const ros::Time& stamp, const ros::Time& arrival);
  /// Of a topic that several sensors share: the rate is that of the arrivals.
  void tickUnordered(const ros::Time& stamp, const ros::Time& arrival);
  void reset();

  double rate() const;                          ///< Hz, over the last stamps; 0: unknown
  double age() const noexcept { return age_; }  ///< s, of the latest message when it arrived
  bool received() const noexcept { return !stamps_.empty(); }
  double silence(const ros::Time& now) const;  ///< s since the latest message

  /// Adds level, summary and figures: ERROR when silent, WARN when rate or age are off.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  StreamExpectation expectation_;
  std::deque<ros::Time> stamps_;
  ros::Time last_arrival_;
  double age_ = 0.0;
};

/// Health of one radar.
class RadarMonitor {
 public:
  /// @param window  s, of the sweeps
  RadarMonitor(std::string topic, StreamExpectation expectation, double window)
      : topic_(std::move(topic)), window_(window), stream_(expectation) {}

  void scan(const ros::Time& stamp, const ros::Time& arrival, const std::string& frame,
            const ExtractionCounts& counts);
  /// A scan found its place in a sweep.
  void used() { ++used_; }
  /// A cloud that could not be read, and why.
  void refuse(const std::string& cause);
  /// The mount of the radar: `error` is empty when TF knows it.
  void mount(const std::string& error) { mount_error_ = error; }
  void reset();

  /// Reports, and starts the next interval.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  std::size_t outside() const;  ///< scans since the last report that no sweep used

  std::string topic_;
  double window_;
  StreamMonitor stream_;
  std::string frame_;
  std::string mount_error_;
  std::string cause_;
  ExtractionCounts counts_;
  std::size_t good_ = 0;     ///< since the last report
  std::size_t used_ = 0;     ///< since the last report
  std::size_t refused_ = 0;  ///< since the last report
  std::size_t refused_in_all_ = 0;
};

/// Health of the estimator.
class EstimatorMonitor {
 public:
  explicit EstimatorMonitor(StreamExpectation expectation) : stream_(expectation) {}

  void estimate(const ros::Time& stamp, const ros::Time& arrival, const EgoVelocityResult& result,
                std::size_t left_out, double computation_time);
  void reset();

  /// Reports, and starts the next interval.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  StreamMonitor stream_;
  std::string reason_;
  double inlier_share_ = 0.0, condition_number_ = 0.0, rms_ = 0.0, computation_time_ = 0.0;
  bool fully_observed_ = true;
  std::size_t valid_ = 0;    ///< since the last report
  std::size_t refused_ = 0;  ///< since the last report
  std::size_t estimates_in_all_ = 0, refused_in_all_ = 0, left_out_in_all_ = 0;
};

}  // namespace radar_dot
