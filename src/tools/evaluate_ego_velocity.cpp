// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;
using radar_dot::evaluation::VelocityEvaluationOptions;
using radar_dot::evaluation::VelocityReport;

constexpr const char* kTool = "evaluate_ego_velocity";

int evaluate(const tools::SceneInput& input, const VelocityEvaluationOptions& options,
             const tools::ResultFiles& files, const std::string& parameters) {
  files.check();
  const dataset::Tables tables = input.load();
  const auto [reports, overall] = tools::evaluateScenes<VelocityReport, radar_dot::evaluation::NoRadarFiles>(
      kTool, tables, !input.scenes.empty(), "radar files",
      [&options](const dataset::Tables& all, dataset::Index scene) {
        return evaluateEgoVelocity(all, scene, options);
      });
  for (const auto& [channel, counts] : overall.missing_files) {
    fmt::print(stderr, "{}: warning: {}: {} of {} files are not on disk; evaluated the others\n", kTool,
               channel, counts.first, counts.second);
  }
  if (overall.frames == 0)
    fmt::print(stderr, "{}: warning: no pair of keyframes to compare with the poses\n", kTool);
  files.write(parameters, reports, overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  radar_dot::Configuration configuration;
  tools::SceneInput input;
  VelocityEvaluationOptions options;
  tools::ResultFiles files;
  tools::CommandLine command_line(
      kTool, "Scores ego velocity, trajectory and static/dynamic labels from radar on a nuScenes dataroot.",
      {"evaluate_ego_velocity --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes scene-0061",
       "evaluate_ego_velocity --dataroot sim --version v1.0-sim --config config/simulation.yaml --json "
       "result.json"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(input));
  command_line.add("", fieldsOf(options));
  command_line.add("", fieldsOf(configuration.ego_velocity));
  command_line.addOutputs("", fieldsOf(files));
  command_line.require(tools::nameOf(input, &input.dataroot));
  return tools::runEvaluator(command_line, kTool, argc, argv, [&] {
    options.ego_velocity = configuration.ego_velocity;
    return evaluate(input, options, files, command_line.parametersJson());
  });
}
