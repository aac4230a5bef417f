// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "radar_dot/evaluation/figures.h"

// Reports of parts of a dataroot, put together as one run over all of it would have written them.

namespace radar_dot::evaluation {

/// What the files of one evaluator's --json hold.
struct SavedReports {
  struct Scene {
    std::string name, sums, where;
  };
  std::vector<Scene> scenes;  ///< in the order of the files
  /// By what it is; but for scenes that another file has.
  std::map<std::string, std::string> left_out;
  /// Those that all files have in common, as JSON, with the scenes by name; empty where a file has none.
  std::string parameters;
};

/// @throws std::runtime_error naming file and field for what is no such file, both files for a scene that
///         stands in two of them, and both for parameters that differ in more than where the data is, which
///         scenes of it, and how many at a time.
SavedReports readReports(const std::string& tool, const std::vector<std::string>& files);

/// @throws std::runtime_error naming file and field for sums of other reports
template <typename Report>
std::vector<Report> scenesOf(const SavedReports& saved) {
  std::vector<Report> scenes;
  for (const SavedReports::Scene& scene : saved.scenes) {
    scenes.emplace_back();
    figuresOf(scenes.back()).readSums(scene.sums, scene.where);
    scenes.back().scene = scene.name;
  }
  return scenes;
}

}  // namespace radar_dot::evaluation
