// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);

#include <opencv2/core/utility.hpp>

namespace radar_dot {
/// Nor does it see the order of OpenCV's own loops.
inline const bool kOpenCvOnOneThread = (cv::setNumThreads(1), true);
}  // namespace radar_dot
#endif

namespace radar_dot {

/// Tells ThreadSanitizer, which does not see into TBB, that tasks come after the beginning of a loop and
/// before its end, in no order among themselves. Nothing otherwise.
class LoopOrder {
#ifdef __SANITIZE_THREAD__
 public:
  LoopOrder() { __tsan_release(&begin_); }
  ~LoopOrder() { __tsan_acquire(&end_); }
  void beginTask() { __tsan_acquire(&begin_); }
  void endTask() { __tsan_release(&end_); }

 private:
  char begin_ = 0, end_ = 0;
#else
 public:
  void beginTask() const noexcept {}
  void endTask() const noexcept {}
#endif
};

/// Calls `row(index)` for every row of an image, on all cores TBB gives.
template <typename Row>
void parallelRows(int rows, const Row& row) {
  constexpr int kRowsPerTask = 16;
  LoopOrder order;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, kRowsPerTask),
                    [&](const tbb::blocked_range<int>& range) {
                      order.beginTask();
                      for (int i = range.begin(); i < range.end(); ++i) row(i);
                      order.endTask();
                    });
}

}  // namespace radar_dot
