// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "command_line.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/dataset/tables.h"

// What the evaluators have in common.

namespace radar_dot::tools {

/// Threads of a network that wait for each other hold their cores, and beside any other program make it
/// several times as slow: let them sleep. To be called before anything else; libgomp, which comes with
/// libtorch, reads it when it is loaded. A value set by the user is kept.
inline void letWaitingThreadsSleep() { setenv("OMP_WAIT_POLICY", "passive", 0); }

/// The scenes of a dataroot.
struct SceneInput {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes;

  void describe(FieldList& fields) {
    fields.group("Input");
    fields.add("dataroot", dataroot, "Folder with the nuScenes tables and sensor files");
    fields.add("version", version, "Folder of the tables in it; v1.0-sim for simulated ones");
    fields.add("scenes", scenes, "Scenes to evaluate, e.g. scene-0061,scene-0103; empty: all");
  }
  dataset::Tables load() const {
    dataset::LoadOptions options;
    options.version = version;
    options.scenes = scenes;
    return dataset::Tables::load(dataroot, options);
  }
};

/// The name of the field that stands for a member.
template <typename Params>
std::string nameOf(const Params& params, const void* member) {
  return fieldsOf(params).of(member).name;
}

/// Fields of a group alone.
inline FieldFilter onlyGroup(const std::string& group) {
  return [group](const Field& field) { return field.group == group; };
}

/// Runs `evaluate`, which returns the exit code, where the command line asks for it. What goes wrong is one
/// line.
template <typename Evaluate>
int runEvaluator(CommandLine& command_line, const char* tool, int argc, char** argv,
                 const Evaluate& evaluate) {
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  try {
    return evaluate();
  } catch (const InvalidParameter& error) {
    return command_line.refuse(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", tool, error.what());
    return EXIT_FAILURE;
  }
}

}  // namespace radar_dot::tools
