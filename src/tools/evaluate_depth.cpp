// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "depth_options.h"
#include "network_options.h"
#include "radar_dot/evaluation/depth_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
using radar_dot::evaluation::DepthEvaluationOptions;
using radar_dot::evaluation::DepthReport;

constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes;
  radar_dot::tools::ResultFiles files;
  DepthEvaluationOptions options;
};

void declare(CLI::App& app, Arguments& arguments) {
  DepthEvaluationOptions& options = arguments.options;
  app.add_option("--dataroot", arguments.dataroot, "Folder with the nuScenes tables and sensor files")
      ->required();
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str();
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channel", options.channel, "Camera")->capture_default_str();
  app.add_option("--radars", options.radar_channels, "Radars, comma-separated (default: all)")
      ->delimiter(',');
  app.add_option("--truth", options.truth,
                 "ground_truth (of a simulated dataroot); lidar: every second point of each beam, which "
                 "--depth lidar then does not see")
      ->capture_default_str();
  app.add_option("--max-images", options.max_images, "The first ones of each scene; 0 = all")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str();
  radar_dot::tools::declareDepthSource(app, options.depth, options.depth_directory,
                                       options.depth_radar_channels);
  radar_dot::tools::declareGrid(app, options.working_width);
  radar_dot::tools::declareDepthParams(app, options.depth_params);
  radar_dot::tools::declareDevice(app, {&options.depth_params.network});
  arguments.files.declare(app);
}

int run(const Arguments& arguments) {
  arguments.files.check();
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  const auto reports = radar_dot::tools::evaluateScenes<DepthReport, radar_dot::evaluation::NoImages>(
      "evaluate_depth", dataset::Tables::load(arguments.dataroot, load), !arguments.scenes.empty(), "images",
      [&arguments](const dataset::Tables& tables, dataset::Index scene) {
        return evaluateDepth(tables, scene, arguments.options);
      });
  if (reports.overall.images == 0) {
    throw std::runtime_error(fmt::format(
        "{}: none of the {} keyframe images has a LIDAR_TOP sweep on disk, as --truth lidar needs",
        arguments.dataroot, reports.overall.without_truth));
  }
  arguments.files.write(reports.scenes, reports.overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  radar_dot::tools::letWaitingThreadsSleep();
  CLI::App app("Scores the depth of camera images on a nuScenes dataroot, as JustDepth is scored.");
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_depth: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_depth: {}\n", error.what());
    return 1;
  }
}
