// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/input_monitor.h"

#include <stdexcept>

namespace radar_dot {

using diagnostic_msgs::DiagnosticStatus;

void checkHeader(const std_msgs::Header& header, const ros::Time& now) {
  if (header.frame_id.empty()) throw std::invalid_argument("its frame_id is empty");
  const std::string defect = stampDefect(header.stamp, now);
  if (!defect.empty()) throw std::invalid_argument(defect);
}

bool InputMonitor::accept(const std_msgs::Header& header, const ros::Time& now) {
  latest_is_good_ = false;
  checkHeader(header, now);
  const StampGuard::Verdict verdict = stamps_.check(header.stamp);
  if (verdict == StampGuard::Verdict::kStale) {
    throw std::invalid_argument("stamp not newer than the previous message's");
  }
  stream_.tick(header.stamp, now);
  ++good_;
  latest_is_good_ = true;
  return verdict == StampGuard::Verdict::kGood;
}

void InputMonitor::acceptUnordered(const std_msgs::Header& header, const ros::Time& now) {
  latest_is_good_ = false;
  checkHeader(header, now);
  stream_.tickUnordered(header.stamp, now);
  ++good_;
  latest_is_good_ = true;
}

void InputMonitor::acceptLatched(const ros::Time& now) {
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

void InputMonitor::reset() {
  stream_.reset();
  stamps_.reset();
  good_ = refused_ = 0;
}

void InputMonitor::report(const ros::Time& now, diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (topic_.empty()) {
    status.summary(DiagnosticStatus::OK, "not subscribed (unused)");
  } else {
    stream_.report(now, status);
    if (refused_ > 0) {
      status.summaryf(good_ > 0 ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                      "%zu messages refused: %s", refused_, cause_.c_str());
    } else if (lasts_) {
      status.summary(DiagnosticStatus::OK, "received");
    } else if (!required_ && status.level == DiagnosticStatus::ERROR) {
      status.level = DiagnosticStatus::OK;  // its words stay
    }
  }
  status.add("topic", topic_);
  status.addf("messages refused", "%zu", refused_in_all_);
  if (refused_in_all_ > 0) status.add("last refusal", cause_);
  good_ = refused_ = 0;
}

}  // namespace radar_dot
