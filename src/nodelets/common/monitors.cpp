// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/monitors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "nodelets/common/read_parameters.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

constexpr std::size_t kRateStamps = 27;  // two seconds of a radar at 13 Hz

// Scans that may wait for their sweep when a report is due.
constexpr std::size_t kWaiting = 1;

// A larger fraction of clouds that did not arrive is worth a warning.
constexpr double kMaxShareLost = 0.05;

}  // namespace

void StreamMonitor::tick(const ros::Time& stamp, const ros::Time& arrival) {
  if (!stamps_.empty() && stamp <= stamps_.back()) stamps_.clear();
  stamps_.push_back(stamp);
  note(stamp, arrival);
}

void StreamMonitor::tickUnordered(const ros::Time& stamp, const ros::Time& arrival) {
  // Several may arrive at one time of a replay's clock.
  if (stamps_.empty() || arrival > stamps_.back()) stamps_.push_back(arrival);
  note(stamp, arrival);
}

void StreamMonitor::note(const ros::Time& stamp, const ros::Time& arrival) {
  if (stamps_.size() > kRateStamps) stamps_.pop_front();
  last_arrival_ = arrival;
  // Differences of ros::Time throw where a wrong stamp is decades away.
  age_ = arrival.toSec() - stamp.toSec();
}

void StreamMonitor::reset() {
  stamps_.clear();
  age_ = 0.0;
}

double StreamMonitor::rate() const {
  if (stamps_.size() < 2) return 0.0;
  return static_cast<double>(stamps_.size() - 1) / (stamps_.back().toSec() - stamps_.front().toSec());
}

double StreamMonitor::silence(const ros::Time& now) const {
  // The clock may have gone back since.
  return received() ? std::max(0.0, now.toSec() - last_arrival_.toSec()) : 0.0;
}

void StreamMonitor::report(const ros::Time& now, DiagnosticStatusWrapper& status) const {
  const double quiet = silence(now);
  const double hertz = rate();
  if (!received()) {
    status.summary(DiagnosticStatus::ERROR, "nothing received yet");
  } else if (quiet > expectation_.silent_after) {
    status.summaryf(DiagnosticStatus::ERROR, "silent for %.1f s", quiet);
  } else if (isOffTheClock()) {
    status.summaryf(DiagnosticStatus::WARN, "stamps are %.2f s %s the clock", std::abs(age_),
                    age_ > 0.0 ? "behind" : "ahead of");
  } else if (hertz > 0.0 && expectation_.rate > 0.0 &&
             std::abs(hertz - expectation_.rate) > expectation_.rate_tolerance * expectation_.rate) {
    status.summaryf(DiagnosticStatus::WARN, "%.1f Hz instead of %.1f Hz", hertz, expectation_.rate);
  } else {
    status.summaryf(DiagnosticStatus::OK, "%.1f Hz", hertz);
  }
  status.addf("rate (Hz)", "%.2f", hertz);
  status.addf("age at arrival (s)", "%.3f", age_);
  status.addf("silence (s)", "%.2f", quiet);
}

void checkHeader(const std_msgs::Header& header, const ros::Time& now) {
  std::string defects = header.frame_id.empty() ? "its frame_id is empty" : "";
  const std::string stamp = stampDefect(header.stamp, now);
  defects += (defects.empty() || stamp.empty() ? "" : "; ") + stamp;
  if (!defects.empty()) throw std::invalid_argument(defects);
}

bool InputMonitor::accept(const std_msgs::Header& header, const ros::Time& now) {
  arrived();
  checkHeader(header, now);
  const StampGuard::Verdict verdict = stamps_.check(header.stamp);
  if (verdict == StampGuard::Verdict::kStale) {
    throw std::invalid_argument("stamp not newer than the previous " + noun_ + "'s");
  }
  stream_.tick(header.stamp, now);
  ++good_;
  latest_is_good_ = true;
  return verdict == StampGuard::Verdict::kGood;
}

void InputMonitor::acceptUnordered(const std_msgs::Header& header, const ros::Time& now) {
  arrived();
  checkHeader(header, now);
  stream_.tickUnordered(header.stamp, now);
  ++good_;
  latest_is_good_ = true;
}

void InputMonitor::acceptLatched(const ros::Time& now) {
  heard_ = true;
  stream_.tick(now, now);
  ++good_;
  latest_is_good_ = lasts_ = true;
}

void InputMonitor::refuse(const std::string& cause) {
  if (latest_is_good_ && good_ > 0) {
    --good_;  // its header was in order, the rest was not
    lasts_ = false;
  }
  latest_is_good_ = false;
  cause_ = cause;
  ++refused_;
  ++refused_in_all_;
}

void InputMonitor::connect(const ros::Subscriber& subscriber) {
  subscriber_ = subscriber;
  topic_ = subscriber.getTopic();
}

void InputMonitor::disconnect() {
  subscriber_.shutdown();
  topic_.clear();
  reset();
}

void InputMonitor::reset() {
  stream_.reset();
  stamps_.reset();
  good_ = refused_ = 0;
  doubt_.clear();
}

void InputMonitor::report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (topic_.empty()) {
    status.summary(DiagnosticStatus::OK, "not subscribed (unused)");
  } else {
    stream_.report(now, status);
    if (refused_ > 0) {
      status.summaryf(good_ > 0 ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR, "%zu %ss refused: %s",
                      refused_, noun_.c_str(), cause_.c_str());
    } else if (lasts_) {
      status.summary(DiagnosticStatus::OK, "received");
    } else if (!required_ && status.level == DiagnosticStatus::ERROR) {
      status.level = DiagnosticStatus::OK;  // its words stay
    }
    if (!doubt_.empty()) status.mergeSummary(DiagnosticStatus::WARN, doubt_);
  }
  status.add("topic", topic_);
  status.addf(noun_ + "s refused", "%zu", refused_in_all_);
  if (refused_in_all_ > 0) status.add("last refusal", cause_);
  good_ = refused_ = 0;
}

bool RadarMonitor::scan(const std::string& frame, const ExtractionCounts& counts, std::size_t lost) {
  const bool is_other = !frame_.empty() && frame != frame_;
  frames_vary_ = frames_vary_ || is_other;
  frame_ = frame;
  counts_ = counts;
  lost_ = lost;
  ++scans_;
  return !is_other;
}

bool RadarMonitor::describe(const std::string& description) {
  if (description == description_) return false;
  description_ = description;
  return true;
}

void RadarMonitor::agreement(const RadarAgreement::Figures& figures, const SweepLosses& losses,
                             double mount_yaw, double mount_yaw_std) {
  figures_ = figures;
  losses_ = losses;
  mount_yaw_ = mount_yaw;
  mount_yaw_std_ = mount_yaw_std;
}

std::size_t RadarMonitor::outside() const { return scans_ > used_ ? scans_ - used_ : 0; }

void RadarMonitor::reset() {
  InputMonitor::reset();
  scans_ = used_ = 0;
}

void RadarMonitor::report(const ros::Time& now, DiagnosticStatusWrapper& status) {
  const bool all_good = !hasRefusals();
  InputMonitor::report(now, status);
  if (all_good && scans_ > 0 && !mount_error_.empty()) {
    status.summary(DiagnosticStatus::ERROR, mount_error_);
  } else if (all_good && outside() > kWaiting && 2 * outside() > scans_) {
    const SweepParams names;
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "%zu of %zu scans outside the window of %.2f s: check its clock or the "
                         "parameter %s",
                         outside(), scans_, window_, nameOf(names, names.window));
  }
  const std::size_t lost = lost_ - lost_at_report_;
  if (static_cast<double>(lost) > kMaxShareLost * static_cast<double>(lost + scans_)) {
    const EgoVelocityConfig names;
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "%zu of %zu clouds lost before they arrived: %s, or the load", lost, lost + scans_,
                         nameOf(names, names.queue_size));
  }
  if (frames_vary_) {
    const RadarEntry names;
    status.mergeSummaryf(DiagnosticStatus::WARN,
                         "clouds of several frames: radars that share a topic need %s",
                         nameOf(names, names.only_frame));
  }
  if (!stream().received() && !other_frame_.empty())
    status.mergeSummary(DiagnosticStatus::ERROR, "only clouds of frame '" + other_frame_ + "' arrive");
  if (stream().isOffTheClock()) {
    const RadarEntry names;
    status.mergeSummaryf(DiagnosticStatus::WARN, "%s: arrival takes the time of arrival, %s corrects a delay",
                         nameOf(names, names.stamp), nameOf(names, names.time_offset));
  }
  if (!range_rate_error_.empty()) status.mergeSummary(DiagnosticStatus::ERROR, range_rate_error_);
  if (!figures_.warning.empty()) status.mergeSummary(DiagnosticStatus::WARN, figures_.warning);
  status.add("reads", description_);
  status.add("frame", frame_);
  status.addf("inlier share", "%.2f", figures_.inlier_share);
  status.addf("median residual (m/s)", "%.3f", figures_.median_residual);
  status.addf("yaw correction of the mount (rad)", "%.4f +- %.4f", figures_.yaw_correction, figures_.yaw_std);
  status.addf("yaw of the mount learnt by the filter (rad)", "%.4f +- %.4f", mount_yaw_, mount_yaw_std_);
  status.addf("returns", "%zu", counts_.total);
  status.addf("returns accepted", "%zu", counts_.accepted);
  status.addf("returns not finite", "%zu", counts_.not_finite);
  // One that waited at the last report may be used since.
  status.addf("scans used", "%zu of %zu", std::min(used_, scans_), scans_);
  status.addf("clouds lost before they arrived", "%zu", lost_);
  status.addf("scans in no sweep", "%zu outside the window, %zu late, %zu at a reset", losses_.outside_window,
              losses_.late, losses_.forgotten);
  scans_ = used_ = 0;
  frames_vary_ = false;
  lost_at_report_ = lost_;
}

void EstimatorMonitor::estimate(const ros::Time& stamp, const ros::Time& arrival,
                                const EgoVelocityResult& result, double computation_time) {
  stream_.tick(stamp, arrival);
  ++estimates_in_all_;
  computation_time_ = computation_time;
  inlier_share_ = result.return_count == 0
                      ? 0.0
                      : static_cast<double>(result.inlier_count) / static_cast<double>(result.return_count);
  condition_number_ = result.condition_number;
  rms_ = result.rms;
  fully_observed_ = result.fully_observed;
  if (result.valid()) {
    ++valid_;
  } else {
    ++refused_;
    ++refused_in_all_;
    reason_ = result.reason;
  }
}

void EstimatorMonitor::reset() {
  stream_.reset();
  valid_ = refused_ = 0;
}

void EstimatorMonitor::report(const ros::Time& now, DiagnosticStatusWrapper& status) {
  stream_.report(now, status);
  if (refused_ > 0) {
    status.summaryf(valid_ > 0 ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                    "%zu of %zu estimates refused: %s", refused_, refused_ + valid_, reason_.c_str());
  } else if (valid_ > 0 && !fully_observed_) {
    status.mergeSummary(DiagnosticStatus::WARN, "the returns do not constrain every component");
  }
  if (!warning_.empty())
    status.mergeSummary(warning_is_error_ ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN, warning_);
  status.addf("inlier share", "%.2f", inlier_share_);
  status.addf("condition number", "%.2f", condition_number_);
  status.addf("rms (m/s)", "%.3f", rms_);
  status.addf("computation time (ms)", "%.3f", 1e3 * computation_time_);
  status.addf("estimates", "%zu", estimates_in_all_);
  status.addf("estimates refused", "%zu", refused_in_all_);
  status.add("last refusal", reason_);
  valid_ = refused_ = 0;
}

}  // namespace radar_dot
