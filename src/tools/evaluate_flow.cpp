// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/flow_evaluation.h"

namespace {

namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

struct Options {
  std::string first, second, truth;  ///< a single pair of images instead of a dataroot
  evaluation::FlowEvaluationOptions evaluation;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("first", first, "First image of a single pair, instead of a dataroot");
    fields.add("second", second, "Second image of the single pair");
    fields.add("flow_truth", truth, "True flow of the single pair, a PNG in KITTI's 16-bit form");
    evaluation.describe(fields);
  }
};

/// A single pair of images, or a dataroot.
void addRules(tools::Evaluator<Options>& evaluator) {
  tools::CommandLine& command_line = evaluator.command_line;
  const Options& options = evaluator.options;
  const auto name_of = [&options](const void* member) { return tools::nameOf(options, member); };
  const auto is_pair = [&options] { return !options.first.empty(); };
  const std::string first = name_of(&options.first);
  evaluator.requireScenes([is_pair] { return !is_pair(); });
  command_line.require(name_of(&options.second), "", is_pair);
  command_line.require(name_of(&options.truth), "", is_pair);
  const evaluation::PairOptions& pairs = options.evaluation.pairs;
  for (const std::string& name :
       {evaluator.dataroot(), evaluator.merge(), name_of(&pairs.pairs), name_of(&pairs.max_pairs),
        name_of(&pairs.camera), tools::nameOf(evaluator.input, &evaluator.input.scenes)})
    command_line.exclude(first, name);
}

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<Options> evaluator(
      "evaluate_flow",
      "Scores optical flow by its end-point error, against the exact flow of a simulated dataroot or on one "
      "pair of images with the true flow, as KITTI has it.",
      {"evaluate_flow --dataroot sim --pairs next",
       "evaluate_flow --first frame1.png --second frame2.png --flow-truth flow_gt.png --working-width 0"},
      "v1.0-sim");
  const radar_dot::Configuration& configuration = evaluator.configuration;
  evaluator.command_line.add("", fieldsOf(configuration.optical_flow));
  evaluator.command_line.add("", fieldsOf(configuration.depth));
  evaluator.command_line.add("", fieldsOf(configuration.ego_velocity), tools::onlyGroup("Returns"));
  addRules(evaluator);
  return evaluator.run(argc, argv, [&evaluator, &configuration] {
    const auto& [first, second, truth, given] = evaluator.options;
    evaluation::FlowEvaluationOptions options = given;
    options.optical_flow = configuration.optical_flow;
    options.depth = configuration.depth;
    options.ego_velocity = configuration.ego_velocity;
    if (!first.empty()) {
      const evaluation::FlowReport report =
          evaluation::evaluateFlow({first, second, truth}, options.optical_flow.flow);
      return evaluator.write({report}, report);
    }
    validate(options);
    evaluation::checkBackend(options.optical_flow.flow);
    if (options.optical_flow.flow.initialisation == radar_dot::FlowStart::kExpected)
      evaluation::checkBackend(options.depth.depth);
    const auto [scenes, overall] = evaluator.scenes(
        [&options](const auto& tables, auto scene) { return evaluateFlow(tables, scene, options); });
    evaluator.write(scenes, overall);
  });
}
