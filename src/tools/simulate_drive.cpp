// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_line.h"
#include "progress_bar.h"
#include "radar_dot/common/enum_names.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/simulation/drive_simulator.h"
#include "radar_dot/simulation/scenario.h"
#include "signal_watch.h"

namespace {

namespace simulation = radar_dot::simulation;
using radar_dot::dataset::DatarootWriter;

enum class Suite { kNone, kMini };

}  // namespace

template <>
struct radar_dot::EnumNames<Suite> {
  static constexpr EnumName<Suite> kValues[] = {{Suite::kNone, "none", "the scenarios of --scenarios"},
                                                {Suite::kMini, "mini", "all ten"}};
};

namespace {

struct Arguments {
  std::string output;
  std::string version = "v1.0-sim";
  Suite suite = Suite::kNone;
  std::vector<std::string> scenarios = {"crossing"};
  simulation::DriveOptions drive;
  bool force = false;
  bool quiet = false;
  bool list = false;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Scenes");
    fields.add("scenarios", scenarios, "Scenarios by name, e.g. crossing,night");
    fields.add("suite", suite, "Set of scenarios");
    fields.add("list", list, "List the scenarios and end");
    fields.group("Output");
    fields.add("output", output, "Folder of the dataroot to make");
    fields.add("version", version, "Folder of the tables in it");
    fields.add("force", force, "Replace a simulated dataroot that exists");
    fields.add("quiet", quiet, "Print errors only");
    drive.describe(fields);
  }
};

std::vector<std::string> scenarioNames(const Arguments& arguments) {
  return arguments.suite == Suite::kMini ? simulation::scenarioNames() : arguments.scenarios;
}

/// Before hours of work: is every scenario known, and named once.
void checkScenarios(const std::vector<std::string>& names) {
  if (names.empty()) throw std::invalid_argument("no scenario is named");
  for (const std::string& name : names) {
    simulation::scenarioInfo(name);
    if (std::count(names.begin(), names.end(), name) > 1)
      throw std::invalid_argument(fmt::format("scenario '{}' is named twice", name));
  }
}

void list() {
  for (const std::string& name : simulation::scenarioNames()) {
    const simulation::ScenarioInfo info = simulation::scenarioInfo(name);
    std::puts(fmt::format("{:14} {}  {}", info.name, info.scene_name, info.description).c_str());
  }
}

void run(Arguments& arguments) {
  simulation::DriveOptions& drive = arguments.drive;
  if (drive.cameras == std::vector<std::string>{"all"}) {
    drive.cameras.clear();
    for (const simulation::CameraMount& mount : simulation::cameraMounts())
      drive.cameras.push_back(mount.channel);
  }
  checkOptions(drive);
  const std::vector<std::string> names = scenarioNames(arguments);
  checkScenarios(names);
  const radar_dot::tools::SignalWatch signals;
  DatarootWriter writer(arguments.output, arguments.version, arguments.force);
  for (std::size_t number = 0; number < names.size(); ++number) {
    const simulation::Scenario scenario =
        simulation::makeScenario(names[number], drive.duration_s, drive.seed);
    radar_dot::tools::ProgressBar bar(
        fmt::format("{} {} ({}/{})", scenario.scene_name, scenario.name, number + 1, names.size()),
        "readings", !arguments.quiet);
    writer.add(simulation::simulateDrive(scenario, drive, number, writer.workFolder(),
                                         [&](std::size_t done, std::size_t total) {
                                           signals.check();
                                           bar.update(done, total);
                                         }));
  }
  signals.check();
  writer.finish();
  if (!arguments.quiet)
    std::puts(fmt::format("{}: {} {} of {:g} s in {}", arguments.output, names.size(),
                          names.size() == 1 ? "scene" : "scenes", drive.duration_s, arguments.version)
                  .c_str());
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // too large a file is an error to report, not a reason to die
  std::signal(SIGPIPE, SIG_IGN);
  Arguments arguments;
  radar_dot::tools::CommandLine command_line(
      "simulate_drive", "Simulates drives through streets and writes them as a nuScenes dataroot.",
      {"simulate_drive --output sim --scenarios crossing,night --duration 10",
       "simulate_drive --output sim --suite mini --frames pairs"});
  command_line.add("", radar_dot::fieldsOf(arguments));
  command_line.require("output", "list", [&arguments] { return !arguments.list; });
  command_line.exclude("scenarios", "suite");
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  return command_line.run("nothing is left of it", [&arguments] {
    try {
      if (arguments.list) return list();
      run(arguments);
    } catch (const radar_dot::InvalidParameter&) {
      throw;
    } catch (const std::invalid_argument& error) {  // names of scenarios and folders are arguments as well
      throw radar_dot::InvalidParameter({}, error.what());
    }
  });
}
