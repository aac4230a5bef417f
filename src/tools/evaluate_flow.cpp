// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "depth_options.h"
#include "network_options.h"
#include "radar_dot/evaluation/flow_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
using radar_dot::evaluation::FlowEvaluationOptions;
using radar_dot::evaluation::FlowPairFiles;
using radar_dot::evaluation::FlowReport;

constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot, version = "v1.0-sim";
  std::vector<std::string> scenes;
  std::string first, second, truth;
  radar_dot::tools::ResultFiles files;
  FlowEvaluationOptions options;
};

void declareInputs(CLI::App& app, Arguments& arguments) {
  FlowEvaluationOptions& options = arguments.options;
  CLI::Option* dataroot = app.add_option("--dataroot", arguments.dataroot,
                                         "Folder that simulate_drive made; needed without --first");
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str()->needs(dataroot);
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")
      ->delimiter(',')
      ->needs(dataroot);
  app.add_option("--channel", options.channel, "Camera")->capture_default_str()->needs(dataroot);
  app.add_option("--pairs", options.pairs, "keyframes: to the next keyframe; next: to the next image")
      ->capture_default_str()
      ->needs(dataroot);
  app.add_option("--max-pairs", options.max_pairs, "The first ones of each scene; 0 = all")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str()
      ->needs(dataroot);
  CLI::Option* first =
      app.add_option("--first", arguments.first, "First image of a single pair, instead of a dataroot");
  CLI::Option* second = app.add_option("--second", arguments.second, "Its second image");
  CLI::Option* truth =
      app.add_option("--truth", arguments.truth, "Its true flow, a PNG in KITTI's 16-bit form");
  first->needs(second)->needs(truth)->excludes(dataroot);
  second->needs(first);
  truth->needs(first);
}

void declareMethod(CLI::App& app, FlowEvaluationOptions& options) {
  radar_dot::OpticalFlowParams& flow = options.optical_flow;
  app.add_option("--flow", options.flow, "dis, torch; of a dataroot also files, ground_truth")
      ->capture_default_str();
  app.add_option("--flow-directory", options.flow_directory, "Folder of 16-bit PNG flows, for --flow files");
  app.add_option("--preset", flow.preset, "ultrafast, fast, medium, fine (dis)")->capture_default_str();
  app.add_option("--initialisation", flow.initialisation,
                 "none; of a dataroot also temporal (flow of the previous pair), expected (flow of a static "
                 "world, by --depth and the true motion)")
      ->capture_default_str();
  app.add_flag("--forward-backward,!--no-forward-backward", flow.forward_backward,
               "Leave out pixels whose forward and backward flow does not close (default: off)");
  app.add_option("--working-width", options.working_width,
                 "px, grid on which flow and truth are compared, with errors in px of the image; 0 = the "
                 "image's")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  radar_dot::tools::declareFlowNetwork(app, flow);
  radar_dot::tools::declareDepthSource(app, options.depth, options.depth_directory,
                                       options.depth_radar_channels);
  radar_dot::tools::declareDepthParams(app, options.depth_params);
  radar_dot::tools::declareDevice(app, {&flow.network, &options.depth_params.network});
}

int run(const Arguments& arguments) {
  arguments.files.check();
  const FlowEvaluationOptions& options = arguments.options;
  if (arguments.dataroot.empty()) {
    radar_dot::OpticalFlowParams params = options.optical_flow;
    params.backend = options.flow;
    params.working_width = options.working_width;
    const FlowPairFiles pair{arguments.first, arguments.second, arguments.truth};
    const FlowReport report = evaluateFlow(pair, params);
    arguments.files.write(std::vector<FlowReport>{report}, report);
    return 0;
  }
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  const auto reports = radar_dot::tools::evaluateScenes<FlowReport, radar_dot::evaluation::NoImages>(
      "evaluate_flow", dataset::Tables::load(arguments.dataroot, load), !arguments.scenes.empty(), "images",
      [&options](const dataset::Tables& tables, dataset::Index scene) {
        return evaluateFlow(tables, scene, options);
      });
  arguments.files.write(reports.scenes, reports.overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  radar_dot::tools::letWaitingThreadsSleep();
  CLI::App app(
      "Scores optical flow by its end-point error, against the exact flow of a simulated dataroot or on one "
      "pair of images with the true flow, as KITTI has it.");
  Arguments arguments;
  declareInputs(app, arguments);
  declareMethod(app, arguments.options);
  arguments.files.declare(app);
  try {
    app.parse(argc, argv);
    if (arguments.dataroot.empty() && arguments.first.empty())
      throw CLI::RequiredError("--dataroot (or --first, --second and --truth)");
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_flow: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_flow: {}\n", error.what());
    return 1;
  }
}
