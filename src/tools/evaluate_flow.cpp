// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/flow_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;
using radar_dot::evaluation::FlowEvaluationOptions;
using radar_dot::evaluation::FlowPairFiles;
using radar_dot::evaluation::FlowReport;

constexpr const char* kTool = "evaluate_flow";

/// A single pair of images instead of a dataroot.
struct PairInput {
  std::string first, second, truth;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("first", first, "First image of a single pair, instead of a dataroot");
    fields.add("second", second, "Second image of the single pair");
    fields.add("flow_truth", truth, "True flow of the single pair, a PNG in KITTI's 16-bit form");
  }
};

int evaluate(const tools::SceneInput& input, const PairInput& pair, const FlowEvaluationOptions& options,
             const tools::ResultFiles& files, const std::string& parameters) {
  files.check();
  if (!pair.first.empty()) {
    const FlowPairFiles images{pair.first, pair.second, pair.truth};
    const FlowReport report = evaluateFlow(images, options.optical_flow.flow);
    files.write(parameters, std::vector<FlowReport>{report}, report);
    return 0;
  }
  const auto reports = tools::evaluateScenes<FlowReport, radar_dot::evaluation::NoImages>(
      kTool, input.load(), !input.scenes.empty(), "images",
      [&options](const dataset::Tables& tables, dataset::Index scene) {
        return evaluateFlow(tables, scene, options);
      });
  files.write(parameters, reports.scenes, reports.overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  tools::letWaitingThreadsSleep();
  radar_dot::Configuration configuration;
  tools::SceneInput input;
  input.version = "v1.0-sim";
  PairInput pair;
  FlowEvaluationOptions options;
  tools::ResultFiles files;
  tools::CommandLine command_line(
      kTool,
      "Scores optical flow by its end-point error, against the exact flow of a simulated dataroot or on one "
      "pair of "
      "images with the true flow, as KITTI has it.",
      {"evaluate_flow --dataroot sim --pairs next",
       "evaluate_flow --first frame1.png --second frame2.png --flow-truth flow_gt.png --working-width 0"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(input));
  command_line.add("", fieldsOf(pair));
  command_line.add("", fieldsOf(options));
  command_line.add("", fieldsOf(configuration.optical_flow));
  command_line.add("", fieldsOf(configuration.depth));
  command_line.add("", fieldsOf(configuration.ego_velocity), tools::onlyGroup("Returns"));
  command_line.addOutputs("", fieldsOf(files));
  const std::string dataroot = tools::nameOf(input, &input.dataroot);
  const std::string first = tools::nameOf(pair, &pair.first);
  const auto is_pair = [&pair] { return !pair.first.empty(); };
  command_line.require(dataroot, first, [&] { return !is_pair(); });
  command_line.require(tools::nameOf(pair, &pair.second), "", is_pair);
  command_line.require(tools::nameOf(pair, &pair.truth), "", is_pair);
  command_line.exclude(first, dataroot);
  for (const void* member :
       {static_cast<const void*>(&options.pairs.pairs), static_cast<const void*>(&options.pairs.max_pairs),
        static_cast<const void*>(&options.pairs.camera)})
    command_line.exclude(first, tools::nameOf(options, member));
  command_line.exclude(first, tools::nameOf(input, &input.scenes));
  return tools::runEvaluator(command_line, kTool, argc, argv, [&] {
    options.optical_flow = configuration.optical_flow;
    options.depth = configuration.depth;
    options.ego_velocity = configuration.ego_velocity;
    return evaluate(input, pair, options, files, command_line.parametersJson());
  });
}
