// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/object_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;
using radar_dot::evaluation::ObjectEvaluationOptions;
using radar_dot::evaluation::ObjectReport;

constexpr const char* kTool = "evaluate_objects";

int evaluate(const tools::SceneInput& input, const ObjectEvaluationOptions& options,
             const tools::ResultFiles& files, const std::string& parameters) {
  files.check();
  const auto [reports, overall] = tools::evaluateScenes<ObjectReport, radar_dot::evaluation::NoRadarFiles>(
      kTool, input.load(), !input.scenes.empty(), "radar files",
      [&options](const dataset::Tables& all, dataset::Index scene) {
        return evaluateObjects(all, scene, options);
      });
  files.write(parameters, reports, overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  radar_dot::Configuration configuration;
  tools::SceneInput input;
  ObjectEvaluationOptions options;
  tools::ResultFiles files;
  tools::CommandLine command_line(
      kTool,
      "Scores tracks of moving objects, from radar and saved masks, against the annotated boxes of a "
      "dataroot.",
      {"evaluate_objects --dataroot /data/nuscenes --config config/nuscenes.yaml",
       "evaluate_objects --dataroot /data/nuscenes --config config/nuscenes.yaml --saved-masks masks --json "
       "result.json"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(input));
  command_line.add("", fieldsOf(options));
  const radar_dot::EgoVelocityConfig& ego = configuration.ego_velocity;
  // The filter is always on, and the ego velocity uses no masks.
  command_line.add("", fieldsOf(configuration.ego_velocity), [&ego](const radar_dot::Field& field) {
    return field.address != &ego.filter && std::string(field.group) != "Mask";
  });
  command_line.add("", fieldsOf(configuration.moving_objects));
  command_line.add("", fieldsOf(configuration.depth));
  command_line.addOutputs("", fieldsOf(files));
  command_line.require(tools::nameOf(input, &input.dataroot));
  return tools::runEvaluator(command_line, kTool, argc, argv, [&] {
    options.ego.ego_velocity = configuration.ego_velocity;
    options.objects = configuration.moving_objects;
    options.depth = configuration.depth;
    return evaluate(input, options, files, command_line.parametersJson());
  });
}
