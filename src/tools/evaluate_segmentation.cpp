// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "depth_options.h"
#include "motion_options.h"
#include "network_options.h"
#include "radar_dot/evaluation/ablation.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "radar_dot/evaluation/loop_comparison.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "segmentation_runner.h"

namespace {

namespace dataset = radar_dot::dataset;
using radar_dot::evaluation::AblationResult;
using radar_dot::evaluation::LoopResult;
using radar_dot::evaluation::SegmentationEvaluationOptions;
using radar_dot::evaluation::SegmentationReport;

constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes, merge;
  int jobs = 1;
  bool compare_loop = false;
  bool ablation = false, best = false;
  std::string initialisation;
  radar_dot::tools::ResultFiles files;
  SegmentationEvaluationOptions options;
};

void declareInputs(CLI::App& app, Arguments& arguments) {
  SegmentationEvaluationOptions& options = arguments.options;
  app.add_option("--dataroot", arguments.dataroot,
                 "Folder with the nuScenes tables and sensor files; needed without --merge");
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str();
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channel", options.channel, "Camera")->capture_default_str();
  app.add_option("--radars", options.radar_channels, "Radars, comma-separated (default: all)")
      ->delimiter(',');
  app.add_option("--pairs", options.pairs,
                 "keyframes: to the next keyframe (the paper); next: to the next image")
      ->capture_default_str();
  app.add_option("--max-pairs", options.max_pairs, "The first ones of each scene; 0 = all")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str();
  app.add_option("--flow", options.flow, "dis, torch, ground_truth, files")->capture_default_str();
  app.add_option("--flow-directory", options.flow_directory, "Folder of 16-bit PNG flows, for --flow files");
  radar_dot::tools::declareDepthSource(app, options.depth, options.depth_directory,
                                       options.depth_radar_channels);
  app.add_option("--velocity", options.velocity, "radar, radar_start, ground_truth")->capture_default_str();
  app.add_option("--rotation", options.rotation, "ground_truth (the paper), radar")->capture_default_str();
  radar_dot::tools::declareGrid(app, options.working_width);
  app.add_option("--doppler-scale", options.extraction.doppler_scale, "Factor on every Doppler velocity")
      ->check(CLI::Range(-10.0, 10.0))
      ->capture_default_str();
  app.add_option(
         "--bearing-delay", options.bearing_delay,
         "s, by which the bearings of returns are later than their velocities; 0 for simulated scenes")
      ->check(CLI::Range(-1.0, 1.0))
      ->capture_default_str();
  app.add_option(
         "--min-true-residual", options.min_true_residual,
         "px; movers whose true flow differs less from a static world's, or that the second image does not "
         "show, do not count, nor do road users that creep too slowly to be annotated as moving. Needs "
         "ground truth")
      ->capture_default_str();
}

void declareMethod(CLI::App& app, Arguments& arguments) {
  SegmentationEvaluationOptions& options = arguments.options;
  radar_dot::MotionParams& motion = options.motion;
  app.add_option("--k", motion.k, "MADs above the median")->capture_default_str();
  app.add_option("--lambda", motion.lambda, "Weight of the depth residual")->capture_default_str();
  app.add_option("--min-depth", motion.min_depth, "Z_min, m")->capture_default_str();
  app.add_option("--foe-std", motion.foe_std, "sigma_FOE, px")->capture_default_str();
  app.add_option("--occlusion-margin", motion.occlusion_margin, "Share of the depth that counts as hidden")
      ->capture_default_str();
  app.add_option_function<double>(
         "--max-depth",
         [&options](double depth) { options.motion.max_depth = options.depth_params.max_depth = depth; },
         "m; farther is unknown, to the score and to the depth backends")
      ->default_val(motion.max_depth);
  app.add_option("--opening", motion.opening, "px")->capture_default_str();
  app.add_option("--closing", motion.closing, "px")->capture_default_str();
  app.add_option("--min-threshold", motion.min_threshold, "Least threshold of the score")
      ->capture_default_str();
  app.add_flag("--predicted-in-view,!--no-predicted-in-view", motion.predicted_in_view,
               "Exclude pixels whose prediction leaves the image (default: on)");
  radar_dot::tools::declareScore(app, motion);
  radar_dot::tools::declareRefinement(app, options.refine, options.motion_uncertainty);
  app.add_flag("--depth-uncertainty,!--no-depth-uncertainty", options.depth_uncertainty,
               "Use what the depth says of its uncertainty, pixel by pixel, instead of --depth-std (default: "
               "off; uncertainty, --refine)");
  app.add_flag("--look-back,!--no-look-back", options.look_back,
               "See the first image also together with the one before (default: off; uncertainty)");
  app.add_option("--memory", options.memory,
                 "s, after which what the mask before said is worth 1 / e; 0 = off (uncertainty)")
      ->capture_default_str();
  radar_dot::OpticalFlowParams& flow = options.optical_flow;
  app.add_option("--preset", flow.preset, "ultrafast, fast, medium, fine (dis)")->capture_default_str();
  app.add_option("--initialisation", arguments.initialisation,
                 "none, expected (flow of a static world); default: expected for dis, none for others");
  app.add_flag("--forward-backward,!--no-forward-backward", flow.forward_backward,
               "Exclude pixels whose forward and backward flow does not close (default: off)");
  radar_dot::tools::declareDepthParams(app, options.depth_params);
  radar_dot::tools::declareFlowNetwork(app, flow);
  radar_dot::tools::declareDevice(app, {&flow.network, &options.depth_params.network});
}

void declareLoop(CLI::App& app, Arguments& arguments) {
  SegmentationEvaluationOptions& options = arguments.options;
  app.add_flag("--mask-to-velocity,!--no-mask-to-velocity", options.mask_to_velocity,
               "Returns in the latest mask are dynamic in the next velocity estimates (default: off)");
  app.add_option("--max-mask-age", options.max_mask_age,
                 "s, from the image of a mask to the scan (--mask-to-velocity)")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--radar-gain", options.motion.radar_gain,
                 "Dynamic returns raise the score by this factor, less 1; 0 = off")
      ->capture_default_str();
  app.add_option("--radar-radius", options.motion.radar_radius, "m, around a dynamic return")
      ->capture_default_str();
  app.add_flag("--compare-loop", arguments.compare_loop,
               "Run with neither of --mask-to-velocity and --radar-gain (its default where it is 0), with "
               "each and with "
               "both, and compare them in a table, and in --json");
}

void declareAblation(CLI::App& app, Arguments& arguments) {
  app.add_flag("--ablation", arguments.ablation,
               "From the paper's masks to the best, step by step: the score by uncertainty, refined motion, "
               "radar evidence, the previous pair, memory; one table, and in --json")
      ->excludes("--compare-loop");
  app.add_flag("--best", arguments.best,
               "All that --ablation adds: --score uncertainty --forward-backward --refine --look-back "
               "--memory 0.4")
      ->excludes("--ablation");
}

void declareOutputs(CLI::App& app, Arguments& arguments) {
  arguments.files.declare(app);
  app.add_option("--save-masks", arguments.options.mask_directory, "Write every mask to this folder, as PNG");
  app.add_option("--jobs", arguments.jobs, "Scenes at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--merge", arguments.merge,
                 "Results of other runs (--json) that become one table; nothing is run")
      ->excludes("--dataroot");
}

/// The reports by scene, and where it was asked for, the comparison.
struct Results {
  std::vector<SegmentationReport> scenes;
  SegmentationReport overall;
  std::vector<LoopResult> loop;
  std::vector<AblationResult> ablation;
};

SegmentationReport sumOf(const std::vector<SegmentationReport>& reports) {
  SegmentationReport sum;
  for (const SegmentationReport& report : reports) sum += report;
  return sum;
}

Results evaluateAll(const Arguments& arguments) {
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  dataset::Tables tables = dataset::Tables::load(arguments.dataroot, load);
  if (!dataset::hasInstanceMasks(tables)) {
    throw std::runtime_error(
        fmt::format("{}/{}/nuinsseg.json: is not there; get nuInsSeg for the masks of nuScenes, or simulate "
                    "(simulate_drive)",
                    arguments.dataroot, arguments.version));
  }
  const std::vector<dataset::InstanceMask> masks = dataset::readInstanceMasks(tables);
  const SegmentationEvaluationOptions& options = arguments.options;
  if (!options.mask_directory.empty()) std::filesystem::create_directories(options.mask_directory);
  std::vector<SegmentationEvaluationOptions> variants = {options};
  std::size_t own = 0;
  if (arguments.compare_loop && arguments.options.velocity == "ground_truth") {
    throw std::invalid_argument("--compare-loop needs a velocity by radar, not --velocity ground_truth");
  }
  if (arguments.ablation) {
    variants.clear();
    for (const auto& step : radar_dot::evaluation::ablationSteps(options)) variants.push_back(step.options);
    own = variants.size() - 1;  // the best
  }
  if (arguments.compare_loop) {
    variants = radar_dot::evaluation::loopVariants(options);
    own = radar_dot::evaluation::ownVariant(options);
  }
  radar_dot::tools::SegmentationRunner runner(tables, masks, variants, arguments.jobs,
                                              !arguments.scenes.empty() || tables.scenes.size() == 1);
  const std::vector<std::vector<SegmentationReport>> reports = runner.run();
  for (const std::string& line : runner.leftOut())
    fmt::print(stderr, "evaluate_segmentation: warning: left out {}\n", line);
  if (reports[own].empty()) throw std::runtime_error(arguments.dataroot + ": no scene has images on disk");
  Results results{reports[own], sumOf(reports[own]), {}, {}};
  if (arguments.ablation) {
    const std::vector<radar_dot::evaluation::AblationStep> steps =
        radar_dot::evaluation::ablationSteps(options);
    for (std::size_t i = 0; i < steps.size(); ++i)
      results.ablation.push_back({steps[i].name, reports[i], sumOf(reports[i])});
  }
  if (!arguments.compare_loop) return results;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    results.loop.push_back(
        {variants[i].mask_to_velocity, variants[i].motion.radar_gain != 0.0, sumOf(reports[i])});
  }
  return results;
}

Results merge(const std::vector<std::string>& files) {
  const std::vector<SegmentationReport> scenes = radar_dot::evaluation::mergeJson(files);
  return {scenes, sumOf(scenes), radar_dot::evaluation::mergeLoop(files),
          radar_dot::evaluation::mergeAblation(files)};
}

int run(const Arguments& arguments) {
  arguments.files.check();
  const Results results = arguments.merge.empty() ? evaluateAll(arguments) : merge(arguments.merge);
  if (!results.ablation.empty()) {
    arguments.files.write(formatJson(results.scenes, results.overall, results.ablation),
                          formatCsv(results.scenes, results.overall), formatAblationTable(results.ablation));
  } else if (results.loop.empty()) {
    arguments.files.write(results.scenes, results.overall);
  } else {
    arguments.files.write(
        formatJson(results.scenes, results.overall, results.loop), formatCsv(results.scenes, results.overall),
        formatTable(results.scenes, results.overall) + "\n" + formatLoopTable(results.loop));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  radar_dot::tools::letWaitingThreadsSleep();
  CLI::App app("Scores dynamic masks against nuInsSeg on a nuScenes dataroot, as the paper's Table I.");
  Arguments arguments;
  arguments.options.extraction.doppler_scale = radar_dot::evaluation::kNuscenesDopplerScale;
  arguments.options.bearing_delay = radar_dot::evaluation::kNuscenesBearingDelay;
  declareInputs(app, arguments);
  declareMethod(app, arguments);
  declareLoop(app, arguments);
  declareAblation(app, arguments);
  declareOutputs(app, arguments);
  try {
    app.parse(argc, argv);
    if (arguments.dataroot.empty() && arguments.merge.empty())
      throw CLI::RequiredError("--dataroot (or --merge)");
    // Half a second between keyframes is more than dis finds from nothing; networks do.
    if (arguments.initialisation.empty())
      arguments.initialisation = arguments.options.flow == "dis" ? "expected" : "none";
    arguments.options.optical_flow.initialisation = arguments.initialisation;
    if (arguments.best) arguments.options = radar_dot::evaluation::bestOptions(arguments.options);
    // What is not known of the ground is one thing, to its depth and to the motion by the image.
    const radar_dot::DepthParams& depth = arguments.options.depth_params;
    radar_dot::RefinementParams& refinement = arguments.options.refinement;
    refinement.ground_pitch_std = depth.ground_pitch_std;
    refinement.ground_height_std = depth.ground_height_std;
    refinement.ground_depth_std = depth.ground_relative_std;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_segmentation: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const radar_dot::tools::Interrupted& interrupt) {
    fmt::print(stderr, "evaluate_segmentation: interrupted; no results are written\n");
    return radar_dot::tools::kSignalBase + interrupt.signal;
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_segmentation: {}\n", error.what());
    return 1;
  }
}
