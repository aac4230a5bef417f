// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <optional>
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
using radar_dot::dataset::LoadOptions;
using radar_dot::dataset::Tables;
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
    fields.add("force", convert.overwrite, "Overwrite bags that exist");
    fields.add("quiet", quiet, "Print warnings and errors only");
  }
};

void printSummary(const ConvertSummary& summary, double seconds) {
  std::string line = fmt::format("{}  {} messages  {:.1f} MB", summary.file.string(), summary.messages,
                                 1e-6 * static_cast<double>(summary.bag_bytes));
  if (summary.radar_files > 0) {
    line += fmt::format("  {:.0f} radar files/s", static_cast<double>(summary.radar_files) / seconds);
  }
  std::puts(line.c_str());
  std::fflush(stdout);
}

void warnOfMissingFiles(const std::map<std::string, FileCount>& missing) {
  for (const auto& [channel, count] : missing) {
    const std::string line = count.missing < count.listed
                                 ? fmt::format("{}: {} of {} files are not on disk; converted the others",
                                               channel, count.missing, count.listed)
                                 : fmt::format("{}: none of the {} files is on disk; converted without them",
                                               channel, count.listed);
    std::fputs((line + "\n").c_str(), stderr);
  }
}

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

  std::map<std::string, FileCount> missing;
  for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
    const auto start = std::chrono::steady_clock::now();
    const ConvertSummary summary = convert(tables, static_cast<Index>(scene), arguments);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    if (!arguments.quiet) printSummary(summary, elapsed.count());
    for (const auto& [channel, count] : summary.missing) {
      missing[channel].missing += count.missing;
      missing[channel].listed += count.listed;
    }
  }
  warnOfMissingFiles(missing);
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
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  return command_line.run("the scene it was at has no bag", [&arguments] { run(arguments); });
}
