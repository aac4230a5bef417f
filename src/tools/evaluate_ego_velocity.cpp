// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"

namespace {

namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<evaluation::VelocityEvaluationOptions> evaluator(
      "evaluate_ego_velocity",
      "Scores ego velocity, trajectory and static/dynamic labels from radar on a nuScenes dataroot.",
      {"evaluate_ego_velocity --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes scene-0061",
       "evaluate_ego_velocity --dataroot sim --version v1.0-sim --config config/simulation.yaml --json "
       "result.json"});
  evaluator.command_line.add("", fieldsOf(evaluator.configuration.ego_velocity));
  evaluator.requireScenes();
  return evaluator.run(argc, argv, [&evaluator] {
    evaluation::VelocityEvaluationOptions& options = evaluator.options;
    options.ego_velocity = evaluator.configuration.ego_velocity;
    validate(options);
    const auto [scenes, overall] = evaluator.scenes(
        [&options](const auto& tables, auto scene) { return evaluateEgoVelocity(tables, scene, options); });
    if (overall.frames == 0)
      fmt::print(stderr, "evaluate_ego_velocity: warning: no pair of keyframes to compare with the poses\n");
    evaluator.write(scenes, overall);
  });
}
