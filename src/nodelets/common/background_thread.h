// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace radar_dot {

/// A thread of lower priority than the others of the process, which does what it is given while the caller
/// waits: where there are too few cores it is images that wait, and not velocities. A thread of a pool cannot
/// lower its own priority for a while, as raising it again is a privilege.
class BackgroundThread {
 public:
  BackgroundThread();
  ~BackgroundThread();
  BackgroundThread(const BackgroundThread&) = delete;
  BackgroundThread& operator=(const BackgroundThread&) = delete;

  /// Returns when `body` has been run, which must not throw. One caller at a time, or `body` itself.
  void run(const std::function<void()>& body);

 private:
  void serve();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* body_ = nullptr;  // none: nothing to do
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace radar_dot
