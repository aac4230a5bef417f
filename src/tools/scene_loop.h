// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/figures.h"

namespace radar_dot::tools {

/// The reports of an evaluator, by scene and together.
template <typename Report>
struct SceneReports {
  std::vector<Report> scenes;
  Report overall;
};

/// Evaluates each variant of each scene, `threads` at a time. A scene whose files are missing or broken is
/// left out of all variants (tables.left_out).
/// @param evaluate  (row of the scene, variant) -> Report
/// @return by variant
/// @throws what else `evaluate` throws, and dataset::DatasetError where no scene is left.
template <typename Report, typename Evaluate>
std::vector<SceneReports<Report>> evaluateScenes(const dataset::Tables& tables, std::size_t variants,
                                                 std::size_t threads_at_most, const Evaluate& evaluate) {
  const std::size_t scenes = tables.scenes.size();
  std::vector<std::optional<Report>> results(scenes * variants);
  std::exception_ptr error;
  std::mutex mutex;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t task = next++; task < results.size(); task = next++) {
      const auto scene = static_cast<dataset::Index>(task / variants);
      try {
        tables.work(scene, [&] { results[task] = evaluate(scene, task % variants); });
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!error) error = std::current_exception();
        next = results.size();
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < std::min(threads_at_most, results.size()); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
  std::vector<SceneReports<Report>> reports(variants);
  for (auto scene = results.begin(); scene != results.end(); scene += static_cast<std::ptrdiff_t>(variants)) {
    const auto end = scene + static_cast<std::ptrdiff_t>(variants);
    if (std::find(scene, end, std::nullopt) != end) continue;
    for (std::size_t variant = 0; variant < variants; ++variant) {
      Report& report = **(scene + static_cast<std::ptrdiff_t>(variant));
      reports[variant].overall += report;
      reports[variant].scenes.push_back(std::move(report));
    }
  }
  if (reports.front().scenes.empty()) tables.failWithoutScenes();
  return reports;
}

}  // namespace radar_dot::tools
