// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
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

/// How scenes are evaluated.
struct SceneLoop {
  const char* tool;      ///< its name, before warnings
  bool asked_for;        ///< the scenes were named
  const char* what;      ///< "images", "radar files": what a scene must have
  std::size_t variants;  ///< of each scene
  std::size_t threads;
};

/// Evaluates each variant of each scene. A dataroot may hold a part of the scenes: one without what is
/// evaluated, of which `Missing` tells, is left out, with a warning; one that was asked for, or the only one,
/// must be there.
/// @param evaluate  (row of the scene, variant) -> Report
/// @return by variant
/// @throws what `evaluate` throws, and std::runtime_error where no scene has what it must have.
template <typename Report, typename Missing, typename Evaluate>
std::vector<SceneReports<Report>> evaluateScenes(const SceneLoop& loop, const dataset::Tables& tables,
                                                 const Evaluate& evaluate) {
  const std::size_t scenes = tables.scenes.size();
  std::vector<std::optional<Report>> results(scenes * loop.variants);
  std::vector<std::string> left_out(scenes);
  std::exception_ptr error;
  std::mutex mutex;
  std::atomic<std::size_t> next{0};
  const auto fail = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!error) error = std::current_exception();
    next = results.size();
  };
  const auto work = [&] {
    for (std::size_t task = next++; task < results.size(); task = next++) {
      const std::size_t scene = task / loop.variants;
      try {
        results[task] = evaluate(static_cast<dataset::Index>(scene), task % loop.variants);
      } catch (const Missing& missing) {
        if (loop.asked_for || scenes == 1) fail();
        const std::lock_guard<std::mutex> lock(mutex);
        left_out[scene] = missing.what();
      } catch (...) {
        fail();
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < std::min(loop.threads, results.size()); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
  for (const std::string& line : left_out)
    if (!line.empty()) fmt::print(stderr, "{}: warning: left out {}\n", loop.tool, line);
  std::vector<SceneReports<Report>> reports(loop.variants);
  for (std::size_t task = 0; task < results.size(); ++task) {
    if (!results[task]) continue;
    SceneReports<Report>& variant = reports[task % loop.variants];
    variant.overall += *results[task];
    variant.scenes.push_back(std::move(*results[task]));
  }
  if (reports.front().scenes.empty()) {
    throw std::runtime_error(
        fmt::format("{}: no scene has {} on disk", tables.dataroot().string(), loop.what));
  }
  return reports;
}

}  // namespace radar_dot::tools
