// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluator.h"
#include "radar_dot/evaluation/calibration_evaluation.h"

namespace {

namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

struct Options : radar_dot::CalibrationParams {
  evaluation::CalibrationReference reference = evaluation::CalibrationReference::kPoses;
  double block = 5.0;

  void describe(radar_dot::FieldList& fields) {
    CalibrationParams::describe(fields);
    fields.add("reference", reference, "What tells the motion beside the radars");
    fields.add("block", block,
               "Every other stretch of this length is held out, to see what the rest is worth", "s",
               {1.0, 60.0});
  }
};

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<Options> evaluator(
      "calibrate_radars", "Finds how radars are turned, placed, scaled and timed from a nuScenes dataroot.",
      {"calibrate_radars --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes "
       "scene-0061,scene-0796"});
  evaluator.command_line.add("", fieldsOf(evaluator.configuration.ego_velocity));
  evaluator.command_line.require(evaluator.dataroot());
  return evaluator.run(argc, argv, [&evaluator] {
    Options& options = evaluator.options;
    const radar_dot::EgoVelocityConfig& config = evaluator.configuration.ego_velocity;
    validate(config);
    options.noise = config.estimator.noise;
    options.bearing_delay = config.bearing_delay;
    const evaluation::CalibrationReport report =
        evaluation::calibrate(evaluation::calibrationData(evaluator.load(), config, options.reference),
                              config, options, options.block);
    evaluator.write(evaluation::formatJson<evaluation::CalibrationReport>({}, report),
                    evaluation::formatCsv<evaluation::CalibrationReport>({}, report), formatTable(report));
  });
}
