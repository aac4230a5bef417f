// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "command_line.h"
#include "progress_bar.h"
#include "radar_dot/bag/scene_converter.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"
#include "signal_watch.h"

namespace {

using radar_dot::bag::ConvertOptions;
using radar_dot::bag::ConvertSummary;
using radar_dot::bag::FileCount;
using radar_dot::dataset::Index;
using radar_dot::dataset::InstanceMask;
using radar_dot::dataset::LeftOut;
using radar_dot::dataset::LoadOptions;
using radar_dot::dataset::Tables;
using radar_dot::tools::DoneInPart;
using radar_dot::tools::SignalWatch;

struct Arguments {
  std::string dataroot;
  LoadOptions load;
  bool all = false;
  std::string output = ".";
  ConvertOptions convert;
  bool masks = true;
  bool quiet = false;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("dataroot", dataroot, "Folder with samples/, sweeps/ and the tables");
    fields.add("version", load.version, "Folder of the tables in it");
    fields.add("scenes", load.scenes, "Scenes to convert, e.g. scene-0061,scene-0103; empty: all");
    fields.add("all", all, "Convert every scene, as without --scenes");
    fields.add("channels", convert.channels, "Sensors to convert, e.g. RADAR_FRONT,CAM_FRONT; empty: all");
    fields.group("Output");
    fields.add("output", output, "Folder for the bags");
    fields.add("compression", convert.compression, "Compression of the bags");
    fields.add("masks", masks, "Write the ground-truth dynamic masks, where there are any");
    fields.add("force", convert.overwrite,
               "Convert again where there is a bag; otherwise a complete one stays");
    fields.add("quiet", quiet, "Print warnings and errors only");
  }
};

void printSummary(const ConvertSummary& summary, double seconds) {
  std::string line =
      fmt::format("{}  {} messages  ", summary.file.string(), summary.messages) +
      (summary.existed ? "were there already"
                       : fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(summary.bag_bytes)));
  if (summary.radar_files > 0) {
    line += fmt::format("  {:.0f} radar files/s", static_cast<double>(summary.radar_files) / seconds);
  }
  std::puts(line.c_str());
  std::fflush(stdout);
}

/// Of one scene.
std::string textOf(const std::map<std::string, FileCount>& missing) {
  std::string text;
  for (const auto& [channel, count] : missing)
    text += fmt::format("{}{} {} of {}", text.empty() ? "not on disk: " : ", ", channel, count.missing,
                        count.listed);
  return text;
}

/// Prints what is left out once it is known.
class Warnings {
 public:
  explicit Warnings(const LeftOut& left_out) : left_out_(left_out) {}
  void print() {
    for (const auto& [what, why] : left_out_.entries())
      if (printed_.insert(what).second) fmt::print(stderr, "nuscenes_to_bag: left out: {}: {}\n", what, why);
  }

 private:
  const LeftOut& left_out_;
  std::set<std::string> printed_;
};

ConvertSummary convert(const Tables& tables, Index scene, const Arguments& arguments) {
  const SignalWatch signals;
  radar_dot::tools::ProgressBar bar(tables.scenes[static_cast<std::size_t>(scene)].name, "readings",
                                    !arguments.quiet);
  return convertScene(tables, scene, arguments.output, arguments.convert,
                      [&](std::size_t done, std::size_t total) {
                        signals.check();
                        bar.update(done, total);
                      });
}

void run(Arguments& arguments) {
  Tables tables = Tables::load(arguments.dataroot, arguments.load);
  std::vector<InstanceMask> masks;
  if (arguments.masks) {
    if (hasInstanceMasks(tables)) masks = readInstanceMasks(tables);
    arguments.convert.masks = &masks;
  }

  Warnings warnings(tables.left_out);
  std::size_t written = 0;
  std::size_t existed = 0;
  for (Index scene = 0; static_cast<std::size_t>(scene) < tables.scenes.size(); ++scene) {
    warnings.print();
    tables.work(scene, [&] {
      const auto start = std::chrono::steady_clock::now();
      const ConvertSummary summary = convert(tables, scene, arguments);
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      ++(summary.existed ? existed : written);
      if (!arguments.quiet) printSummary(summary, elapsed.count());
      if (!summary.missing.empty())
        tables.left_out.add(at(tables.scenes, scene).name + " (sensor files)", textOf(summary.missing));
    });
  }
  if (written + existed == 0) tables.failWithoutScenes();
  warnings.print();
  if (!arguments.quiet)
    std::puts(fmt::format("{} scenes, their bags: {} written, {} complete before, {} missing",
                          tables.scenes.size(), written, existed, tables.scenes.size() - written - existed)
                  .c_str());
  if (!tables.left_out.entries().empty()) throw DoneInPart("done in part: see what is left out, above");
}

}  // namespace

int main(int argc, char** argv) {
  // A limit on file sizes, or a reader of our output that has gone, is an error to report and to
  // clean up after, not a reason to die on the spot.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);

  Arguments arguments;
  radar_dot::tools::CommandLine command_line(
      "nuscenes_to_bag", "Converts scenes of a nuScenes dataset to rosbags, one <scene>.bag each.",
      {"nuscenes_to_bag --dataroot DIR --output bags",
       "nuscenes_to_bag --dataroot DIR --scenes scene-0061,scene-0103 --channels RADAR_FRONT --no-masks"});
  command_line.add("", radar_dot::fieldsOf(arguments));
  command_line.require("dataroot");
  command_line.exclude("all", "scenes");
  command_line.leavesOut("what is missing or broken in the dataroot");
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  return command_line.run("the scene it was at has no bag", [&arguments] { run(arguments); });
}
