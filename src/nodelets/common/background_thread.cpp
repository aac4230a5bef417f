// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/background_thread.h"

#include <sys/resource.h>

namespace radar_dot {
namespace {

constexpr int kNice = 5;  // a third of the weight of the others

}  // namespace

BackgroundThread::BackgroundThread() : thread_([this] { serve(); }) {}

BackgroundThread::~BackgroundThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundThread::run(const std::function<void()>& body) {
  if (std::this_thread::get_id() == thread_.get_id()) return body();
  std::unique_lock<std::mutex> lock(mutex_);
  body_ = &body;
  changed_.notify_all();
  changed_.wait(lock, [this] { return body_ == nullptr; });
}

void BackgroundThread::serve() {
  // Of this thread alone on Linux; threads that it starts, as those of OpenCV, inherit it.
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNice);
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || body_ != nullptr; });
    if (stop_) return;
    lock.unlock();
    (*body_)();
    lock.lock();
    body_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace radar_dot
