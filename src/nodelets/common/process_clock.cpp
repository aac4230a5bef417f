// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/process_clock.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace radar_dot {

struct ProcessTimer::Recorded {
  std::function<void()> callback;
  ros::Duration period;
  Kind kind;
  bool is_running;
  ros::Time due;
};

namespace {

std::atomic<bool>& isFollowing() {
  static std::atomic<bool> following(false);
  return following;
}

}  // namespace

std::vector<std::weak_ptr<ProcessTimer::Recorded>>& ProcessTimer::recorded() {
  static std::vector<std::weak_ptr<Recorded>> timers;
  return timers;
}

ros::WallTime ProcessClock::now() {
  if (!isRecorded()) return ros::WallTime::now();
  const ros::Time now = ros::Time::now();
  return {now.sec, now.nsec};
}

bool ProcessClock::isRecorded() { return isFollowing(); }

void ProcessClock::follow(const ros::Time& start) {
  isFollowing() = true;
  ros::Time::setNow(start);
}

void ProcessClock::advanceTo(const ros::Time& time, const std::function<void()>& after_each) {
  for (;;) {
    std::shared_ptr<ProcessTimer::Recorded> next;
    for (const std::weak_ptr<ProcessTimer::Recorded>& known : ProcessTimer::recorded()) {
      const std::shared_ptr<ProcessTimer::Recorded> timer = known.lock();
      if (timer && timer->is_running && timer->due <= time && (!next || timer->due < next->due)) next = timer;
    }
    if (!next) break;
    ros::Time::setNow(std::max(ros::Time::now(), next->due));
    next->is_running = next->kind == ProcessTimer::Kind::kRepeating;
    next->due += next->period;
    next->callback();
    after_each();
  }
  ros::Time::setNow(std::max(ros::Time::now(), time));
}

ProcessTimer::ProcessTimer(const ros::NodeHandle& handle, double period, std::function<void()> callback,
                           Kind kind) {
  const bool runs = kind == Kind::kRepeating;
  if (!ProcessClock::isRecorded()) {
    wall_ = handle.createWallTimer(
        ros::WallDuration(period),
        [callback = std::move(callback)](const ros::WallTimerEvent&) { callback(); }, !runs, runs);
    return;
  }
  recorded_ = std::make_shared<Recorded>(Recorded{std::move(callback), ros::Duration(period), kind, runs,
                                                  ros::Time::now() + ros::Duration(period)});
  recorded().push_back(recorded_);
}

void ProcessTimer::stop() {
  wall_.stop();
  if (recorded_) recorded_->is_running = false;
}

void ProcessTimer::restart(double period) {
  if (recorded_) {
    recorded_->period = ros::Duration(period);
    recorded_->due = ros::Time::now() + recorded_->period;
    recorded_->is_running = true;
    return;
  }
  wall_.stop();
  wall_.setPeriod(ros::WallDuration(period));
  wall_.start();
}

}  // namespace radar_dot
