// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace radar_dot {

/// Calls `row(index)` for every row of an image, on all cores TBB gives.
template <typename Row>
void parallelRows(int rows, const Row& row) {
  constexpr int kRowsPerTask = 16;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, kRowsPerTask),
                    [&](const tbb::blocked_range<int>& range) {
                      for (int i = range.begin(); i < range.end(); ++i) row(i);
                    });
}

}  // namespace radar_dot
