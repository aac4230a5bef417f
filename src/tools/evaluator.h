// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_line.h"
#include "evaluation/merged_reports.h"
#include "parameter_document.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "result_files.h"
#include "scene_loop.h"

// What the evaluators have in common.

namespace radar_dot::tools {

/// Threads of a network that wait for each other hold their cores, and beside any other program make it
/// several times as slow: let them sleep. To be called before anything else; libgomp, which comes with
/// libtorch, reads it when it is loaded. A value set by the user is kept.
inline void letWaitingThreadsSleep() { setenv("OMP_WAIT_POLICY", "passive", 0); }

/// The scenes of a dataroot, or reports of them.
struct SceneInput {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes, merge;

  void describe(FieldList& fields) {
    fields.group("Input");
    fields.add("dataroot", dataroot, "Folder with the nuScenes tables and sensor files");
    fields.add("version", version, "Folder of the tables in it; v1.0-sim for simulated ones");
    fields.add("scenes", scenes, "Scenes to evaluate, e.g. scene-0061,scene-0103; empty: all");
    fields.add("merge", merge,
               "Reports of other runs (--json) that become one, in this order, instead of a dataroot");
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

/// A tool that scores the scenes of a dataroot. Options describes what is in no section of a configuration
/// file; what it uses of those the tool adds to the command line.
template <typename Options>
struct Evaluator {
  Configuration configuration;
  SceneInput input;
  Options options;
  ResultFiles files;
  CommandLine command_line;
  dataset::LeftOut left_out;
  std::string parameters;  ///< of merged reports

  Evaluator(const std::string& tool, const std::string& purpose, const std::vector<std::string>& examples,
            const std::string& version = SceneInput().version)
      : command_line(tool, purpose, examples), tool_(tool) {
    letWaitingThreadsSleep();
    input.version = version;
    command_line.leavesOut("what is missing or broken in the dataroot");
    command_line.setSections(sectionsOf(configuration));
    command_line.add("", fieldsOf(input));
    command_line.add("", fieldsOf(options));
  }
  // The command line refers to the members.
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  std::string dataroot() const { return nameOf(input, &input.dataroot); }
  std::string merge() const { return nameOf(input, &input.merge); }

  /// There must be scenes, or reports of them. @param condition  where; empty: always
  void requireScenes(const std::function<bool()>& condition = {}) {
    command_line.require(dataroot(), merge(),
                         [this, condition] { return input.merge.empty() && (!condition || condition()); });
    command_line.exclude(merge(), dataroot());
  }

  /// Runs `evaluate()` where the command line asks for it. What goes wrong is one line.
  /// @return the exit code
  template <typename Evaluate>
  int run(int argc, char** argv, const Evaluate& evaluate) {
    command_line.addOutputs("", fieldsOf(files));
    if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
    return command_line.run("no results are written", [&] {
      files.check();
      evaluate();
      if (!left_out.entries().empty())
        throw DoneInPart("done in part: see what is left out, below the table");
    });
  }

  /// The tables of the scenes, which know what is left out of the result.
  dataset::Tables load() {
    dataset::LoadOptions load;
    load.version = input.version;
    load.scenes = input.scenes;
    dataset::Tables tables = dataset::Tables::load(input.dataroot, load);
    left_out = tables.left_out;
    warnOfRealRadars(tables);
    return tables;
  }

  /// The reports of --merge.
  template <typename Report>
  SceneReports<Report> merged() {
    const evaluation::SavedReports saved = evaluation::readReports(tool_, input.merge);
    SceneReports<Report> reports{evaluation::scenesOf<Report>(saved), {}};
    for (const Report& scene : reports.scenes) reports.overall += scene;
    for (const auto& [what, why] : saved.left_out) left_out.add(what, why);
    parameters = saved.parameters;
    return reports;
  }

  /// Those of --merge, or evaluates all scenes by evaluate(tables, row of the scene) -> Report, see
  /// scene_loop.h.
  template <typename Evaluate>
  auto scenes(const Evaluate& evaluate) {
    using Report = decltype(evaluate(std::declval<const dataset::Tables&>(), dataset::Index()));
    if (!input.merge.empty()) return merged<Report>();
    const dataset::Tables tables = load();
    return evaluateScenes<Report>(tables, 1, 1,
                                  [&](dataset::Index scene, std::size_t) { return evaluate(tables, scene); })
        .front();
  }

  template <typename Report>
  void write(const std::vector<Report>& scenes, const Report& overall) const {
    write(formatJson(scenes, overall), formatCsv(scenes, overall), formatTable(scenes, overall));
  }
  /// With what was left out: below the table, and as "left_out" in JSON, by what it is.
  void write(const std::string& json, const std::string& csv, std::string table) const {
    const std::map<std::string, std::string> entries = left_out.entries();
    if (!entries.empty()) table += "\nLeft out:\n";
    for (const auto& [what, why] : entries) table += fmt::format("  {}: {}\n", what, why);
    files.write(parameters.empty() ? command_line.parametersJson() : parameters, withLeftOut(json, entries),
                csv, table);
  }

 private:
  /// The radars of simulate_drive are exact: what corrects those of nuScenes makes them worse.
  void warnOfRealRadars(const dataset::Tables& tables) const {
    const EgoVelocityConfig& radars = configuration.ego_velocity;
    const bool corrects = radars.extraction.doppler_scale != 1.0 || radars.bearing_delay != 0.0;
    const auto is_simulated = [](const dataset::Log& log) { return log.vehicle == "simulated"; };
    if (corrects && std::any_of(tables.logs.begin(), tables.logs.end(), is_simulated))
      fmt::print(
          stderr,
          "{}: is simulated, but {} {} and {} {} correct real radars; --config config/simulation.yaml\n",
          input.dataroot, nameOf(configuration.ego_velocity, &radars.extraction.doppler_scale),
          radars.extraction.doppler_scale, nameOf(configuration.ego_velocity, &radars.bearing_delay),
          radars.bearing_delay);
  }

  std::string tool_;
};

}  // namespace radar_dot::tools
