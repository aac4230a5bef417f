// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::tools {

/// The reports of an evaluator, by scene and together.
template <typename Report>
struct SceneReports {
  std::vector<Report> scenes;
  Report overall;
};

/// Evaluates scene by scene. A dataroot may hold a part of the scenes: one without what is evaluated, of
/// which `Missing` tells, is left out, with a warning; one that was asked for, or the only one, must be
/// there.
/// @param tool      its name, before the warning
/// @param what      "images", "radar files": what a scene must have
/// @param evaluate  (tables, row of the scene) -> Report
/// @throws what `evaluate` throws, and std::runtime_error where no scene has it.
template <typename Report, typename Missing, typename Evaluate>
SceneReports<Report> evaluateScenes(const char* tool, const dataset::Tables& tables, bool asked_for,
                                    const char* what, const Evaluate& evaluate) {
  SceneReports<Report> reports;
  for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
    try {
      reports.scenes.push_back(evaluate(tables, static_cast<dataset::Index>(scene)));
      reports.overall += reports.scenes.back();
    } catch (const Missing& error) {
      if (asked_for || tables.scenes.size() == 1) throw;
      fmt::print(stderr, "{}: warning: left out {}\n", tool, error.what());
    }
  }
  if (reports.scenes.empty())
    throw std::runtime_error(fmt::format("{}: no scene has {} on disk", tables.dataroot().string(), what));
  return reports;
}

}  // namespace radar_dot::tools
