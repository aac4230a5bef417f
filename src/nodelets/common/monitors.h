// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/subscriber.h>
#include <ros/time.h>
#include <std_msgs/Header.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "nodelets/inputs/stamp_guard.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/radar_agreement.h"
#include "radar_dot/radar/sweep_assembler.h"

namespace radar_dot {

/// What is expected of a stream of stamped messages.
struct StreamExpectation {
  double rate = 13.0;           ///< Hz; 0: any
  double rate_tolerance = 0.3;  ///< fraction of the rate
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
  /// The stamp of the latest message was too far from the clock.
  bool isOffTheClock() const { return received() && std::abs(age_) > expectation_.max_age; }
  double silence(const ros::Time& now) const;  ///< s since the latest message

  /// Adds level, summary and figures: ERROR when silent, WARN when rate or age are off.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  void note(const ros::Time& stamp, const ros::Time& arrival);

  StreamExpectation expectation_;
  std::deque<ros::Time> stamps_;
  ros::Time last_arrival_;
  double age_ = 0.0;
};

/// Checks that hold for every stamped message: frame given, stamp given and not ahead of the clock.
/// @throws std::invalid_argument saying all that is wrong
void checkHeader(const std_msgs::Header& header, const ros::Time& now);

/// One input of a nodelet: its order of stamps, its health, and what was refused of it.
class InputMonitor {
 public:
  /// @param name      for logs and diagnostics, as in "depth"
  /// @param required  false: its silence is no error
  /// @param noun      of one of its messages, for texts
  InputMonitor(std::string name, StreamExpectation expectation, bool required, std::string noun = "message")
      : name_(std::move(name)), noun_(std::move(noun)), required_(required), stream_(expectation) {}
  virtual ~InputMonitor() = default;
  InputMonitor(const InputMonitor&) = default;
  InputMonitor& operator=(const InputMonitor&) = default;

  const std::string& name() const noexcept { return name_; }
  const std::string& noun() const noexcept { return noun_; }
  /// Resolved name, once subscribed; empty: not subscribed now.
  const std::string& topic() const noexcept { return topic_; }
  void setTopic(std::string topic) { topic_ = std::move(topic); }
  void connect(const ros::Subscriber& subscriber);
  /// Ends the subscription, and resets.
  void disconnect();
  std::uint32_t publishers() const { return subscriber_.getNumPublishers(); }

  /// @param max_age  s between stamp and arrival, above which the report warns
  void expectMaxAge(double max_age) { stream_.expectMaxAge(max_age); }

  /// A message has arrived, whatever becomes of it: comes before all of the following.
  void arrived() {
    heard_ = true;
    latest_is_good_ = false;
  }
  /// Takes a message into the order. @return false when time restarted with it: everything from before is
  /// to be forgotten. @throws std::invalid_argument as checkHeader(), and for a stamp not after the one
  /// before.
  bool accept(const std_msgs::Header& header, const ros::Time& now);
  /// The same for messages that several sources send on one topic, in no order.
  void acceptUnordered(const std_msgs::Header& header, const ros::Time& now);
  /// What holds until the next one comes, as a calibration: any stamp, and silence is no error afterwards.
  void acceptLatched(const ros::Time& now);
  /// What is probably wrong with the messages that are used: a WARN until it is empty.
  void doubt(const std::string& doubt) { doubt_ = doubt; }
  /// The latest message cannot be used, whether it was accepted or not.
  void refuse(const std::string& cause);
  virtual void reset();
  /// Has anything arrived, refused or not?
  bool heard() const noexcept { return heard_; }
  bool hasRefusals() const noexcept { return refused_ > 0; }  ///< since the last report
  std::size_t refusedInAll() const noexcept { return refused_in_all_; }
  const StreamMonitor& stream() const noexcept { return stream_; }

  /// Reports, and starts the next interval.
  virtual void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  std::string name_, noun_, topic_;
  ros::Subscriber subscriber_;
  bool required_;
  StreamMonitor stream_;
  StampGuard stamps_;
  std::string cause_, doubt_;
  bool heard_ = false;
  bool latest_is_good_ = false;
  bool lasts_ = false;
  std::size_t good_ = 0;     // since the last report
  std::size_t refused_ = 0;  // since the last report
  std::size_t refused_in_all_ = 0;
};

/// Health of one radar.
class RadarMonitor final : public InputMonitor {
 public:
  /// @param window  s, of the sweeps
  RadarMonitor(std::string name, StreamExpectation expectation, double window)
      : InputMonitor(std::move(name), expectation, true, "cloud"), window_(window) {}

  /// A cloud that was read, for a sweep. @param lost  messages that have not arrived, in all
  /// @return false: the frame is another than before
  bool scan(const std::string& frame, const ExtractionCounts& counts, std::size_t lost);
  /// What is read, and how. @return true when it is news
  bool describe(const std::string& description);
  /// A message of a shared topic is of another radar.
  void other(const std::string& frame) { other_frame_ = frame; }
  /// How the radar agrees with the others, and which of its scans came into no sweep.
  /// @param mount_yaw, mount_yaw_std  rad, as the velocity filter has learnt it
  void agreement(const RadarAgreement::Figures& figures, const SweepLosses& losses, double mount_yaw,
                 double mount_yaw_std);
  /// Why its velocities are no range rates; empty: they are.
  void rangeRates(const std::string& error) { range_rate_error_ = error; }
  /// A scan found its place in a sweep.
  void used() { ++used_; }
  /// The mount of the radar: `error` is empty when TF knows it.
  void mount(const std::string& error) { mount_error_ = error; }
  void reset() override;
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status) override;

 private:
  std::size_t outside() const;  ///< scans since the last report that no sweep used

  double window_;
  std::string frame_, other_frame_, description_;
  std::string mount_error_, range_rate_error_;
  ExtractionCounts counts_;
  RadarAgreement::Figures figures_;
  SweepLosses losses_;
  double mount_yaw_ = 0.0, mount_yaw_std_ = 0.0;  ///< rad
  bool frames_vary_ = false;                      ///< since the last report
  std::size_t scans_ = 0;                         ///< since the last report
  std::size_t used_ = 0;                          ///< since the last report
  std::size_t lost_ = 0;                          ///< in all
  std::size_t lost_at_report_ = 0;                ///< at the last report
};

/// Health of the estimator.
class EstimatorMonitor {
 public:
  explicit EstimatorMonitor(StreamExpectation expectation) : stream_(expectation) {}

  void estimate(const ros::Time& stamp, const ros::Time& arrival, const EgoVelocityResult& result,
                double computation_time);
  /// What contradicts the estimates; empty: nothing. @param is_error  they are no measurement
  void warn(std::string warning, bool is_error) {
    warning_ = std::move(warning);
    warning_is_error_ = is_error;
  }
  void reset();

  /// Reports, and starts the next interval.
  void report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  StreamMonitor stream_;
  std::string reason_, warning_;
  double inlier_share_ = 0.0, condition_number_ = 0.0, rms_ = 0.0, computation_time_ = 0.0;
  bool fully_observed_ = true, warning_is_error_ = false;
  std::size_t valid_ = 0;    ///< since the last report
  std::size_t refused_ = 0;  ///< since the last report
  std::size_t estimates_in_all_ = 0, refused_in_all_ = 0;
};

}  // namespace radar_dot
