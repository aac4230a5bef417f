// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/depth_evaluation.h"

namespace {

namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<evaluation::DepthEvaluationOptions> evaluator(
      "evaluate_depth", "Scores the depth of camera images on a nuScenes dataroot, as JustDepth is scored.",
      {"evaluate_depth --dataroot sim --version v1.0-sim --config config/simulation.yaml",
       "evaluate_depth --dataroot /data/nuscenes --config config/nuscenes.yaml --depth-backend lidar"});
  evaluator.command_line.add("", fieldsOf(evaluator.configuration.depth));
  evaluator.command_line.add("", fieldsOf(evaluator.configuration.optical_flow.flow));
  evaluator.command_line.add("", fieldsOf(evaluator.configuration.ego_velocity), tools::onlyGroup("Returns"));
  evaluator.requireScenes();
  return evaluator.run(argc, argv, [&evaluator] {
    evaluation::DepthEvaluationOptions& options = evaluator.options;
    options.ego_velocity = evaluator.configuration.ego_velocity;
    options.depth = evaluator.configuration.depth;
    options.truth = truthOf(options, evaluator.input.dataroot);
    options.optical_flow = evaluator.configuration.optical_flow;
    options.motion_uncertainty = evaluator.configuration.dynamic_segmentation.motion_uncertainty;
    validate(options);
    evaluation::checkBackend(options.depth.depth);
    const auto [scenes, overall] = evaluator.scenes(
        [&options](const auto& tables, auto scene) { return evaluateDepth(tables, scene, options); });
    if (overall.images == 0) {
      throw std::runtime_error(fmt::format(
          "{}: none of the {} keyframe images has a LIDAR_TOP sweep on disk, as the truth lidar needs",
          evaluator.input.dataroot, overall.without_truth));
    }
    evaluator.write(scenes, overall);
  });
}
