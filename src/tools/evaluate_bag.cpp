// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "evaluation/recorded_motion.h"
#include "evaluator.h"
#include "progress_bar.h"

namespace {

namespace bag = radar_dot::bag;
namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using radar_dot::fieldsOf;

struct Options {
  std::vector<std::string> bags;
  bag::BagSelection part;
  evaluation::RecordingOptions recording;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("bags", bags, "Bags of a recording, which are read as one; --bags may be left out");
    part.describe(fields);
    recording.describe(fields);
  }
};

}  // namespace

int main(int argc, char** argv) {
  radar_dot::Configuration configuration;  // has no effect here; --config reads reports
  Options options;
  tools::ResultFiles files;
  tools::CommandLine command_line(
      "evaluate_bag", "Compares velocities, paths, masks and objects in a bag with a reference in it.",
      {"evaluate_bag out.bag --reference /ground_truth/odom --json result.json",
       "evaluate_bag out.bag gnss.bag --reference /gps/fix --align-time",
       "evaluate_bag foreign.bag --twist /radar/twist --odometry \"\" --reference tf:map:base_link"});
  command_line.setSections(sectionsOf(configuration));
  command_line.add("", fieldsOf(options));
  command_line.addOutputs("", fieldsOf(files));
  command_line.takeWords("bags", "BAG");
  command_line.require("bags");
  command_line.require("reference");
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  return command_line.run("no results are written", [&] {
    files.check();
    const bag::BagInput input({options.bags.begin(), options.bags.end()}, options.part);
    const auto whole = static_cast<std::size_t>((input.end() - input.begin()).toSec());
    evaluation::MotionReport report;
    {
      tools::ProgressBar bar("evaluate_bag", "s");
      report = evaluation::evaluateRecording(
          input, options.recording,
          [](const std::string& doubt) { fmt::print(stderr, "evaluate_bag: warning: {}\n", doubt); },
          [&](double done) { bar.update(static_cast<std::size_t>(done), whole); });
    }
    report.scene = std::filesystem::path(options.bags.front()).stem().string();
    files.write(command_line.parametersJson(), evaluation::formatJson(std::vector{report}, report),
                evaluation::formatCsv(std::vector{report}, report), evaluation::formatTable(report));
  });
}
