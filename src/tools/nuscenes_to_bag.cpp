// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "progress_bar.h"
#include "radar_dot/bag/scene_converter.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"
#include "signal_watch.h"

namespace {

using radar_dot::bag::Compression;
using radar_dot::bag::ConvertOptions;
using radar_dot::bag::ConvertSummary;
using radar_dot::bag::FileCount;
using radar_dot::dataset::Index;
using radar_dot::dataset::InstanceMask;
using radar_dot::dataset::LoadOptions;
using radar_dot::dataset::Tables;
using radar_dot::tools::Interrupted;
using radar_dot::tools::SignalWatch;

constexpr int kFailure = 1;
constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot;
  LoadOptions load;
  bool all = false;
  std::string output = ".";
  std::string compression = "none";
  std::vector<std::string> channels;
  bool force = false;
  bool no_masks = false;
  bool quiet = false;
};

void addOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--dataroot", arguments.dataroot, "Folder with samples/, sweeps/ and the tables")
      ->required();
  app.add_option("--version", arguments.load.version, "Folder of the tables (default: v1.0-mini)");
  CLI::Option* scenes =
      app.add_option("--scenes", arguments.load.scenes, "Scenes to convert, e.g. scene-0061,scene-0103")
          ->delimiter(',');
  app.add_flag("--all", arguments.all, "Convert every scene (the default)")->excludes(scenes);
  app.add_option("--channels", arguments.channels,
                 "Sensors to convert, e.g. RADAR_FRONT,CAM_FRONT (default: all)")
      ->delimiter(',');
  app.add_option("--output", arguments.output, "Folder for the bags (default: .)");
  app.add_option("--compression", arguments.compression, "none, lz4 or bz2 (default: none)")
      ->check(CLI::IsMember({"none", "lz4", "bz2"}));
  app.add_flag("--force", arguments.force, "Overwrite bags that exist");
  app.add_flag("--no-masks", arguments.no_masks, "Leave the ground-truth dynamic masks out");
  app.add_flag("--quiet", arguments.quiet, "Print warnings and errors only");
}

Compression compressionOf(const std::string& name) {
  if (name == "lz4") return Compression::kLz4;
  return name == "bz2" ? Compression::kBz2 : Compression::kNone;
}

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

ConvertSummary convert(const Tables& tables, Index scene, const Arguments& arguments,
                       const ConvertOptions& options) {
  const SignalWatch signals;
  radar_dot::tools::ProgressBar bar(tables.scenes[static_cast<std::size_t>(scene)].name, "readings",
                                    !arguments.quiet);
  return convertScene(tables, scene, arguments.output, options, [&](std::size_t done, std::size_t total) {
    signals.check();
    bar.update(done, total);
  });
}

void run(const Arguments& arguments) {
  Tables tables = Tables::load(arguments.dataroot, arguments.load);
  std::vector<InstanceMask> masks;
  if (!arguments.no_masks && hasInstanceMasks(tables)) masks = readInstanceMasks(tables);
  ConvertOptions options;
  options.channels = arguments.channels;
  options.compression = compressionOf(arguments.compression);
  options.overwrite = arguments.force;
  options.masks = arguments.no_masks ? nullptr : &masks;

  std::map<std::string, FileCount> missing;
  for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
    const auto start = std::chrono::steady_clock::now();
    const ConvertSummary summary = convert(tables, static_cast<Index>(scene), arguments, options);
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

  CLI::App app("Converts scenes of a nuScenes dataset to rosbags, one <scene>.bag each.", "nuscenes_to_bag");
  Arguments arguments;
  addOptions(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fputs(fmt::format("nuscenes_to_bag: {}; see --help\n", error.what()).c_str(), stderr);
    return kUsage;
  }
  try {
    run(arguments);
  } catch (const Interrupted& interrupt) {
    std::fputs("nuscenes_to_bag: interrupted; the scene it was at has no bag\n", stderr);
    return radar_dot::tools::kSignalBase + interrupt.signal;
  } catch (const std::exception& error) {
    std::fputs(fmt::format("nuscenes_to_bag: {}\n", error.what()).c_str(), stderr);
    return kFailure;
  }
  return 0;
}
