// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/object_evaluation.h"

namespace {

namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<evaluation::ObjectEvaluationOptions> evaluator(
      "evaluate_objects",
      "Scores tracks of moving objects, from radar and saved masks, against the annotated boxes of a "
      "dataroot.",
      {"evaluate_objects --dataroot /data/nuscenes --config config/nuscenes.yaml",
       "evaluate_objects --dataroot /data/nuscenes --config config/nuscenes.yaml --saved-masks masks --json "
       "result.json"});
  const radar_dot::Configuration& configuration = evaluator.configuration;
  const radar_dot::EgoVelocityConfig& ego = configuration.ego_velocity;
  // The filter is always on, and the ego velocity uses no masks.
  evaluator.command_line.add("", fieldsOf(ego), [&ego](const radar_dot::Field& field) {
    return field.address != &ego.filter && std::string(field.group) != "Mask";
  });
  evaluator.command_line.add("", fieldsOf(configuration.moving_objects));
  evaluator.command_line.add("", fieldsOf(configuration.depth));
  evaluator.requireScenes();
  return evaluator.run(argc, argv, [&evaluator, &configuration] {
    evaluation::ObjectEvaluationOptions& options = evaluator.options;
    options.ego.ego_velocity = configuration.ego_velocity;
    options.objects = configuration.moving_objects;
    options.depth = configuration.depth;
    validate(options);
    if (!options.masks.directory.empty()) evaluation::checkBackend(options.depth.depth);
    const auto [scenes, overall] = evaluator.scenes(
        [&options](const auto& tables, auto scene) { return evaluateObjects(tables, scene, options); });
    evaluator.write(scenes, overall);
  });
}
