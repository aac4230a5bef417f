// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluator.h"
#include "radar_dot/evaluation/ablation.h"
#include "radar_dot/evaluation/loop_comparison.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "segmentation_runner.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;
using radar_dot::evaluation::AblationResult;
using radar_dot::evaluation::LoopResult;
using radar_dot::evaluation::SegmentationEvaluationOptions;
using radar_dot::evaluation::SegmentationReport;

constexpr const char* kTool = "evaluate_segmentation";

struct Arguments {
  tools::SceneInput input;
  std::vector<std::string> merge;
  int jobs = 1;
  bool compare_loop = false, ablation = false, best = false;
  tools::ResultFiles files;
  SegmentationEvaluationOptions options;

  void describe(radar_dot::FieldList& fields) {
    input.describe(fields);
    fields.add("merge", merge, "Reports of other runs (--json) that become one table, instead of a dataroot");
    fields.add("jobs", jobs, "Scenes that are evaluated at a time", "", {1, 1024});
    options.describe(fields);
    fields.group("Comparison");
    fields.add(
        "ablation", ablation,
        "From the paper's masks to the best, step by step: score by uncertainty, refined motion, radar "
        "evidence, previous pair, memory; one table, and in --json");
    fields.add("best", best,
               "All that --ablation adds: --score uncertainty --forward-backward --refine --refine-ground "
               "--look-back "
               "--memory 0.4");
    fields.add(
        "compare_loop", compare_loop,
        "Run with neither of --mask-to-velocity and --radar-gain (its default where it is 0), with each and "
        "with both, and compare them in a table, and in --json");
  }
};

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
  dataset::Tables tables = arguments.input.load();
  if (!dataset::hasInstanceMasks(tables)) {
    throw std::runtime_error(
        fmt::format("{}/{}/nuinsseg.json: is not there; get nuInsSeg for the masks of nuScenes, or simulate "
                    "(simulate_drive)",
                    arguments.input.dataroot, arguments.input.version));
  }
  const std::vector<dataset::InstanceMask> masks = dataset::readInstanceMasks(tables);
  const SegmentationEvaluationOptions& options = arguments.options;
  std::vector<SegmentationEvaluationOptions> variants = {options};
  std::size_t own = 0;
  if (arguments.compare_loop) {
    radar_dot::require(options.velocity != radar_dot::evaluation::VelocitySource::kGroundTruth,
                       fieldsOf(options), {&options.velocity}, "--compare-loop needs a velocity by radar");
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
  for (const SegmentationEvaluationOptions& variant : variants)
    if (!variant.mask_directory.empty()) std::filesystem::create_directories(variant.mask_directory);
  radar_dot::tools::SegmentationRunner runner(tables, masks, variants, arguments.jobs,
                                              !arguments.input.scenes.empty() || tables.scenes.size() == 1);
  const std::vector<std::vector<SegmentationReport>> reports = runner.run();
  for (const std::string& line : runner.leftOut())
    fmt::print(stderr, "{}: warning: left out {}\n", kTool, line);
  if (reports[own].empty())
    throw std::runtime_error(arguments.input.dataroot + ": no scene has images on disk");
  Results results{reports[own], sumOf(reports[own]), {}, {}};
  if (arguments.ablation) {
    const std::vector<radar_dot::evaluation::AblationStep> steps =
        radar_dot::evaluation::ablationSteps(options);
    for (std::size_t i = 0; i < steps.size(); ++i)
      results.ablation.push_back({steps[i].name, reports[i], sumOf(reports[i])});
  }
  if (!arguments.compare_loop) return results;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    results.loop.push_back({variants[i].mask_to_velocity,
                            variants[i].segmentation.motion.radar.dynamic_gain != 0.0, sumOf(reports[i])});
  }
  return results;
}

Results merge(const std::vector<std::string>& files) {
  const std::vector<SegmentationReport> scenes = radar_dot::evaluation::mergeJson(files);
  return {scenes, sumOf(scenes), radar_dot::evaluation::mergeLoop(files),
          radar_dot::evaluation::mergeAblation(files)};
}

int run(const Arguments& arguments, const std::string& parameters) {
  arguments.files.check();
  const Results results = arguments.merge.empty() ? evaluateAll(arguments) : merge(arguments.merge);
  if (!results.ablation.empty()) {
    arguments.files.write(parameters, formatJson(results.scenes, results.overall, results.ablation),
                          formatCsv(results.scenes, results.overall), formatAblationTable(results.ablation));
  } else if (results.loop.empty()) {
    arguments.files.write(parameters, results.scenes, results.overall);
  } else {
    arguments.files.write(
        parameters, formatJson(results.scenes, results.overall, results.loop),
        formatCsv(results.scenes, results.overall),
        formatTable(results.scenes, results.overall) + "\n" + formatLoopTable(results.loop));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  tools::letWaitingThreadsSleep();
  radar_dot::Configuration configuration;
  Arguments arguments;
  // Half a second between keyframes is more than dis finds from zero; networks do, and start from it below.
  radar_dot::OpticalFlowParams& flow = configuration.optical_flow.flow;
  flow.initialisation = radar_dot::FlowStart::kExpected;
  tools::CommandLine command_line(
      kTool, "Scores dynamic masks against nuInsSeg on a nuScenes dataroot, as the paper's Table I.",
      {"evaluate_segmentation --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes scene-0103 "
       "--best",
       "evaluate_segmentation --dataroot sim --version v1.0-sim --config config/simulation.yaml --config "
       "config/masks.yaml --pairs next"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(arguments));
  command_line.add("", fieldsOf(configuration.dynamic_segmentation));
  command_line.add("", fieldsOf(configuration.optical_flow));
  command_line.add("", fieldsOf(configuration.depth));
  command_line.add("", fieldsOf(configuration.ego_velocity));
  command_line.addOutputs("", fieldsOf(arguments.files));
  const auto name_of = [&arguments](const void* member) { return tools::nameOf(arguments, member); };
  const std::string dataroot = name_of(&arguments.input.dataroot);
  command_line.require(dataroot, name_of(&arguments.merge), [&] { return arguments.merge.empty(); });
  command_line.exclude(name_of(&arguments.merge), dataroot);
  command_line.exclude(name_of(&arguments.ablation), name_of(&arguments.compare_loop));
  command_line.exclude(name_of(&arguments.ablation), name_of(&arguments.best));
  return tools::runEvaluator(command_line, kTool, argc, argv, [&] {
    SegmentationEvaluationOptions& options = arguments.options;
    if (!command_line.givenMember(&flow.initialisation) &&
        flow.backend != radar_dot::OpticalFlowParams{}.backend)
      flow.initialisation = radar_dot::FlowStart::kNone;
    options.ego_velocity = configuration.ego_velocity;
    options.optical_flow = configuration.optical_flow;
    options.depth = configuration.depth;
    options.segmentation = configuration.dynamic_segmentation;
    if (arguments.best) {
      options = radar_dot::evaluation::bestOptions(options);
      configuration.optical_flow = options.optical_flow;
      configuration.dynamic_segmentation = options.segmentation;
    }
    try {
      return run(arguments, command_line.parametersJson());
    } catch (const tools::Interrupted& interrupt) {
      fmt::print(stderr, "{}: interrupted; no results are written\n", kTool);
      return tools::kSignalBase + interrupt.signal;
    }
  });
}
