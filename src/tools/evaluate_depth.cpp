// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/depth_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;
using radar_dot::evaluation::DepthEvaluationOptions;
using radar_dot::evaluation::DepthReport;

constexpr const char* kTool = "evaluate_depth";

int evaluate(const tools::SceneInput& input, const DepthEvaluationOptions& options,
             const tools::ResultFiles& files, const std::string& parameters) {
  files.check();
  const auto reports = tools::evaluateScenes<DepthReport, radar_dot::evaluation::NoImages>(
      kTool, input.load(), !input.scenes.empty(), "images",
      [&options](const dataset::Tables& tables, dataset::Index scene) {
        return evaluateDepth(tables, scene, options);
      });
  if (reports.overall.images == 0) {
    throw std::runtime_error(fmt::format(
        "{}: none of the {} keyframe images has a LIDAR_TOP sweep on disk, as the truth lidar needs",
        input.dataroot, reports.overall.without_truth));
  }
  files.write(parameters, reports.scenes, reports.overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  tools::letWaitingThreadsSleep();
  radar_dot::Configuration configuration;
  tools::SceneInput input;
  DepthEvaluationOptions options;
  tools::ResultFiles files;
  tools::CommandLine command_line(
      kTool, "Scores the depth of camera images on a nuScenes dataroot, as JustDepth is scored.",
      {"evaluate_depth --dataroot sim --version v1.0-sim --config config/simulation.yaml",
       "evaluate_depth --dataroot /data/nuscenes --config config/nuscenes.yaml --depth-backend lidar --truth "
       "lidar"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(input));
  command_line.add("", fieldsOf(options));
  command_line.add("", fieldsOf(configuration.depth));
  command_line.add("", fieldsOf(configuration.ego_velocity), tools::onlyGroup("Returns"));
  command_line.addOutputs("", fieldsOf(files));
  command_line.require(tools::nameOf(input, &input.dataroot));
  return tools::runEvaluator(command_line, kTool, argc, argv, [&] {
    options.ego_velocity = configuration.ego_velocity;
    options.depth = configuration.depth;
    return evaluate(input, options, files, command_line.parametersJson());
  });
}
