// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "progress_bar.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/simulation/drive_simulator.h"
#include "radar_dot/simulation/scenario.h"
#include "signal_watch.h"

namespace {

namespace simulation = radar_dot::simulation;
using radar_dot::dataset::DatarootWriter;

constexpr int kFailure = 1;
constexpr int kUsage = 2;

struct Arguments {
  std::string output;
  std::string version = "v1.0-sim";
  std::string suite;
  std::vector<std::string> scenarios;
  simulation::DriveOptions drive;
  bool force = false;
  bool quiet = false;
  bool list = false;
};

void addOptions(CLI::App& app, Arguments& arguments) {
  simulation::DriveOptions& drive = arguments.drive;
  static const std::map<std::string, simulation::CameraFrames> kFrames = {
      {"all", simulation::CameraFrames::kAll},
      {"pairs", simulation::CameraFrames::kPairs},
      {"keyframes", simulation::CameraFrames::kKeyframes}};
  static const std::map<std::string, simulation::GroundTruth> kTruths = {
      {"all", simulation::GroundTruth::kAll},
      {"keyframes", simulation::GroundTruth::kKeyframes},
      {"none", simulation::GroundTruth::kNone}};
  app.add_option("--output", arguments.output, "Folder of the dataroot to make");
  app.add_option("--version", arguments.version, "Folder of the tables in it (default: v1.0-sim)");
  CLI::Option* suite = app.add_option("--suite", arguments.suite, "Set of scenarios: mini (all ten)")
                           ->check(CLI::IsMember({"mini"}));
  app.add_option("--scenarios", arguments.scenarios,
                 "Scenarios by name, e.g. crossing,night (default: crossing)")
      ->delimiter(',')
      ->excludes(suite);
  app.add_flag("--list", arguments.list, "List the scenarios and end");
  app.add_option("--duration", drive.duration_s, "Of each scene, s (default: 20)");
  app.add_option("--width", drive.width, "Of the images, px (default: 1600)");
  app.add_option("--height", drive.height, "Of the images, px (default: 900)");
  app.add_option("--cameras", drive.cameras, "Channels, or 'all' (default: CAM_FRONT)")->delimiter(',');
  app.add_option("--frames", drive.frames,
                 "all images, pairs (keyframes and the image after each) or keyframes (default: all)")
      ->transform(CLI::CheckedTransformer(kFrames).description("{all,pairs,keyframes}"));
  app.add_option("--camera-rate", drive.camera_rate, "Hz (default: 12)");
  app.add_option("--radar-rate", drive.radar_rate, "Hz; 0 = no radars (default: 13)");
  app.add_option("--lidar-rate", drive.lidar_rate, "Hz; 2 = keyframes only, 0 = no lidar (default: 20)");
  app.add_option("--ground-truth", drive.ground_truth,
                 "Exact depth, flow, occlusion and masks of CAM_FRONT for all images, keyframes or none "
                 "(default: all)")
      ->transform(CLI::CheckedTransformer(kTruths).description("{all,keyframes,none}"));
  app.add_option("--seed", drive.seed, "Same seed, same bytes (default: 1)");
  app.add_option("--threads", drive.threads, "0 = one per core (default)");
  app.add_flag("--force", arguments.force, "Replace a simulated dataroot that exists");
  app.add_flag("--quiet", arguments.quiet, "Print errors only");
}

std::vector<std::string> scenarioNames(const Arguments& arguments) {
  if (!arguments.suite.empty()) return simulation::scenarioNames();
  return arguments.scenarios.empty() ? std::vector<std::string>{"crossing"} : arguments.scenarios;
}

/// Before hours of work: is every scenario known, and named once.
void checkScenarios(const std::vector<std::string>& names) {
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
  CLI::App app("Simulates drives through streets and writes them as a nuScenes dataroot.", "simulate_drive");
  Arguments arguments;
  addOptions(app, arguments);
  try {
    app.parse(argc, argv);
    if (!arguments.list && arguments.output.empty()) throw CLI::RequiredError("--output");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fputs(fmt::format("simulate_drive: {}; see --help\n", error.what()).c_str(), stderr);
    return kUsage;
  }
  try {
    if (arguments.list)
      list();
    else
      run(arguments);
  } catch (const radar_dot::tools::Interrupted& interrupt) {
    std::fputs("simulate_drive: interrupted; nothing is left of it\n", stderr);
    return radar_dot::tools::kSignalBase + interrupt.signal;
  } catch (const std::invalid_argument& error) {
    std::fputs(fmt::format("simulate_drive: {}; see --help\n", error.what()).c_str(), stderr);
    return kUsage;
  } catch (const std::exception& error) {
    std::fputs(fmt::format("simulate_drive: {}\n", error.what()).c_str(), stderr);
    return kFailure;
  }
  return 0;
}
