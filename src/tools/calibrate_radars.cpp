// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/mount_yaws.h"
#include "config/mounts_file.h"
#include "evaluation/recorded_calibration.h"
#include "evaluator.h"
#include "progress_bar.h"

namespace {

namespace bag = radar_dot::bag;
namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

struct Options : radar_dot::CalibrationParams {
  std::vector<std::string> bags;
  bag::BagSelection part;
  std::string tf;
  std::vector<std::string> reference;
  double block = 5.0;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Recording");
    fields.add("bags", bags, "Instead of a dataroot, bags, which are read as one; --bags may be left out");
    part.describe(fields);
    fields.add("tf", tf,
               "YAML list of mounts that the bags lack: {parent: base_link, child: radar, x: 3.5, y: 0, z: "
               "0.5, roll: 0, pitch: 0, yaw: 0}; m, rad");
    CalibrationParams::describe(fields);
    fields.add("reference", reference,
               "What tells the motion beside the radars, of a dataroot: poses (by default), wheels (speed of "
               "the CAN bus) or none; of bags: topics of Odometry, TwistStamped, TwistWithCovarianceStamped, "
               "Imu or NavSatFix, tf:FIXED_FRAME:FRAME, or none (the rear axle does not slip)");
    fields.add("block", block,
               "Of a single drive, every other stretch of this length is held out, to see what the rest "
               "is worth; of several drives, each in turn",
               "s", {1.0, 60.0});
  }
};

struct Outputs {
  std::string mount_yaws, mounts;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Output");
    fields.add("mount_yaws", mount_yaws, "Write the yaws as a mount_yaws_file of the nodelet");
    fields.add("mounts", mounts, "Write the mounts as a list for --tf, in place of mount_yaw_correction");
  }
  void write(const evaluation::CalibrationReport& report, const std::string& base_frame) const {
    const char* why = !report.isWorthIt()         ? "what was held out agrees less than before"
                      : report.mount_yaws.empty() ? "the drive shows no yaw"
                                                  : nullptr;
    for (const std::string& file : {mount_yaws, mounts})
      if (why != nullptr && !file.empty()) warn(file + " is not written: " + why);
    if (why != nullptr) return;
    if (!mount_yaws.empty()) radar_dot::writeMountYaws(mount_yaws, report.mount_yaws);
    std::vector<radar_dot::Mount> list;
    for (const auto& [frame, mount] : report.mounts) list.emplace_back(base_frame, frame, mount);
    if (!mounts.empty()) radar_dot::writeMounts(mounts, list);
  }
  static void warn(const std::string& text) { fmt::print(stderr, "calibrate_radars: warning: {}\n", text); }
};

evaluation::CalibrationReference ofDataroot(const Options& options) {
  if (options.reference.empty()) return {};
  try {
    if (options.reference.size() > 1) throw std::invalid_argument("it is a list");
    return radar_dot::fromString<evaluation::CalibrationReference>(options.reference.front());
  } catch (const std::invalid_argument& error) {
    throw radar_dot::InvalidParameter({"reference"}, std::string("reference of a dataroot: ") + error.what());
  }
}

evaluation::CalibrationData recordedData(const Options& options, const radar_dot::EgoVelocityConfig& config) {
  const bag::BagInput input({options.bags.begin(), options.bags.end()}, options.part);
  const auto whole = static_cast<std::size_t>((input.end() - input.begin()).toSec());
  tools::ProgressBar bar("calibrate_radars", "s");
  return evaluation::recordedCalibrationData(
      input, config, options.reference, options.tf, Outputs::warn,
      [&](double done) { bar.update(static_cast<std::size_t>(done), whole); });
}

}  // namespace

int main(int argc, char** argv) {
  tools::Evaluator<Options> evaluator(
      "calibrate_radars",
      "Finds how radars are turned, placed, scaled and timed from bags or a nuScenes dataroot.",
      {"calibrate_radars drive.bag --config my.yaml --reference /odom,/imu/data --mount-yaws yaws.yaml",
       "calibrate_radars --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes "
       "scene-0061,scene-0796"});
  Options& options = evaluator.options;
  Outputs outputs;
  tools::CommandLine& command_line = evaluator.command_line;
  command_line.add("", fieldsOf(evaluator.configuration.ego_velocity));
  command_line.addOutputs("", fieldsOf(outputs));
  command_line.takeWords("bags", "BAG");
  command_line.require("bags", evaluator.dataroot(), [&] { return evaluator.input.dataroot.empty(); });
  for (const char* of_bags : {"bags", "start", "duration", "tf"})
    command_line.exclude(evaluator.dataroot(), of_bags);
  return evaluator.run(argc, argv, [&] {
    const radar_dot::EgoVelocityConfig& config = evaluator.configuration.ego_velocity;
    validate(config);
    options.noise = config.estimator.noise;
    options.bearing_delay = config.bearing_delay;
    const evaluation::CalibrationData data =
        options.bags.empty() ? evaluation::calibrationData(evaluator.load(), config, ofDataroot(options))
                             : recordedData(options, config);
    options.rate_has_bias = data.rate_has_bias;
    const evaluation::CalibrationReport report = evaluation::calibrate(data, config, options, options.block);
    evaluator.write(evaluation::formatJson<evaluation::CalibrationReport>({}, report),
                    evaluation::formatCsv<evaluation::CalibrationReport>({}, report), formatTable(report));
    outputs.write(report, config.base_frame);
  });
}
