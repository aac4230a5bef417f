// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "radar_dot/evaluation/object_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

using radar_dot::evaluation::ObjectEvaluationOptions;
using radar_dot::evaluation::ObjectReport;

constexpr int kUsage = 2;
constexpr double kDegree = 0.017453292519943295;

struct Arguments {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes;
  double max_azimuth = 60.0;  // degrees
  bool strict_returns = false, all_returns = false;
  radar_dot::tools::ResultFiles files;
  ObjectEvaluationOptions options;
};

void addNumber(CLI::App& app, const char* name, double& value, double lowest, double highest,
               const char* meaning) {
  app.add_option(name, value, meaning)->check(CLI::Range(lowest, highest))->capture_default_str();
}

void declare(CLI::App& app, Arguments& arguments) {
  ObjectEvaluationOptions& options = arguments.options;
  app.add_option("--dataroot", arguments.dataroot, "Folder with the nuScenes tables and sensor files")
      ->required();
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str();
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channels", options.ego.channels, "Radars, comma-separated (default: all)")
      ->delimiter(',');
  arguments.files.declare(app);
  addNumber(app, "--doppler-scale", options.ego.extraction.doppler_scale, -10.0, 10.0,
            "Factor on every Doppler velocity");
  addNumber(app, "--bearing-delay", options.ego.bearing_delay, -1.0, 1.0,
            "s, by which the bearings of returns are later than their velocities; 0 for simulated scenes");
  addNumber(app, "--max-range", options.max_range, 1.0, 1000.0, "m, of the objects that count");
  addNumber(app, "--max-azimuth", arguments.max_azimuth, 1.0, 180.0,
            "Degrees to either side of straight ahead, of the objects that count");
  addNumber(app, "--margin", options.margin, 0.0, 10.0, "m, by which boxes are grown");
  addNumber(app, "--min-speed", options.min_speed, 0.01, 10.0, "m/s, slowest box that moves");
  app.add_flag("!--no-doubtful", arguments.options.doubtful, "Doubtful returns carry on no track");
  app.add_flag("--strict-returns", arguments.strict_returns,
               "Seek objects only in the returns that the ego velocity is estimated from");
  app.add_flag("--all-returns", arguments.all_returns, "Seek objects in all returns, whatever their states");
}

void declareObjects(CLI::App& app, ObjectEvaluationOptions& options) {
  addNumber(app, "--isolated-threshold", options.returns.segmentation.isolated_threshold, 0.01, 100.0,
            "m/s, a single return that moves");
  addNumber(app, "--supported-threshold", options.returns.segmentation.supported_threshold, 0.01, 100.0,
            "m/s, a return that moves with another one");
  addNumber(app, "--azimuth-std", options.returns.azimuth_std, 0.0, 1.0, "rad, 1 sigma of a bearing");
  addNumber(app, "--range-std", options.returns.range_std, 0.0, 10.0, "m, 1 sigma of a range");
  addNumber(app, "--group-distance", options.detection.max_distance, 0.01, 100.0,
            "m, between neighbouring returns of one object");
  addNumber(app, "--group-velocity", options.detection.max_velocity_difference, 0.01, 100.0,
            "m/s, between their velocities");
  addNumber(app, "--extent-std", options.detection.extent_std, 0.0, 10.0,
            "m, 1 sigma of where on an object its returns gather");
  addNumber(app, "--shared-velocity-std", options.detection.shared_velocity_std, 0.0, 10.0,
            "m/s, 1 sigma of what the returns on an object share");
  addNumber(app, "--weak-threshold", options.detection.weak_threshold, 0.0, 1000.0,
            "m/s, static returns at least this fast may carry on a track");
  radar_dot::ObjectTrackerParams& tracker = options.tracker;
  addNumber(app, "--acceleration-std", tracker.acceleration_std, 0.01, 100.0, "m/s^2, of the objects");
  addNumber(app, "--initial-speed-std", tracker.initial_speed_std, 0.1, 100.0,
            "m/s, 1 sigma of what is not known of the velocity of a new track");
  addNumber(app, "--gate", tracker.gate, 0.1, 100.0, "Sigma, from a track to its detection");
  app.add_option("--confirm-hits", tracker.confirm_hits, "Detections that confirm a track")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--confirm-scans", tracker.confirm_scans, "Scans of one radar they must come in")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  addNumber(app, "--min-coast", tracker.min_coast, 0.01, 10.0, "s, a new track lives without detections");
  addNumber(app, "--max-coast", tracker.max_coast, 0.01, 10.0, "s, the same of an old one");
  addNumber(app, "--max-weak-time", tracker.max_weak_time, 0.01, 100.0, "s, with weak detections alone");
  addNumber(app, "--min-body-length", tracker.min_body_length, 0.01, 100.0, "m, of what gives one track");
  addNumber(app, "--max-body-length", tracker.max_body_length, 0.01, 100.0, "m, the same of fast bodies");
  addNumber(app, "--max-body-width", tracker.max_body_width, 0.01, 100.0, "m, the same across the heading");
  addNumber(app, "--body-time", tracker.body_time, 0.0, 100.0, "s, length of a body per speed");
  addNumber(app, "--body-velocity", tracker.body_velocity, 0.0, 100.0, "m/s, within one body");
  addNumber(app, "--min-track-speed", tracker.min_speed, 0.0, 100.0, "m/s, slowest track that is reported");
}

void declareMasks(CLI::App& app, ObjectEvaluationOptions& options) {
  radar_dot::evaluation::ObjectMaskOptions& masks = options.masks;
  app.add_option("--masks", masks.directory,
                 "Folder of evaluate_segmentation --save-masks: regions of moving pixels are detections too");
  app.add_option("--mask-channel", masks.channel, "Camera of the masks")->capture_default_str();
  app.add_option("--mask-depth", masks.depth,
                 "radar_ground, lidar, ground_truth, noisy, files: depth of their images")
      ->capture_default_str();
  app.add_option("--mask-depth-directory", masks.depth_directory,
                 "Folder of 16-bit PNG depths, for --mask-depth files");
  addNumber(
      app, "--mask-delay", masks.delay, 0.0, 10.0,
      "s, from an image to the time its mask is known, at most --max-lag; what a vehicle has is 0.5 for "
      "masks of pairs of keyframes");
  addNumber(app, "--max-lag", options.tracker.max_lag, 0.0, 10.0,
            "s, by which a scan or mask may be older than the newest scan");
  app.add_flag("--mask-starts-tracks", masks.starts_tracks,
               "Regions start tracks, too (default: they only carry on those of the radar)");
  app.add_option("--mask-min-pixels", masks.regions.min_pixels,
                 "Smaller regions are left out, px of a grid 800 wide")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

int run(Arguments& arguments) {
  arguments.files.check();
  namespace dataset = radar_dot::dataset;
  ObjectEvaluationOptions& options = arguments.options;
  options.max_azimuth = kDegree * arguments.max_azimuth;
  if (arguments.strict_returns && arguments.all_returns)
    throw std::invalid_argument("--strict-returns and --all-returns exclude each other");
  if (arguments.strict_returns) options.filter = options.ego.extraction.filter;
  if (arguments.all_returns) {
    options.filter.invalid_states.clear();
    options.filter.ambig_states.clear();
    options.filter.pdh0_states.clear();
  }
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  const dataset::Tables tables = dataset::Tables::load(arguments.dataroot, load);

  const auto [reports, overall] =
      radar_dot::tools::evaluateScenes<ObjectReport, radar_dot::evaluation::NoRadarFiles>(
          "evaluate_objects", tables, !arguments.scenes.empty(), "radar files",
          [&options](const dataset::Tables& all, dataset::Index scene) {
            return evaluateObjects(all, scene, options);
          });
  arguments.files.write(reports, overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Scores tracks of moving objects, from radar and saved masks, against the annotated boxes of a "
      "dataroot.");
  Arguments arguments;
  arguments.options.ego.extraction.doppler_scale = radar_dot::evaluation::kNuscenesDopplerScale;
  arguments.options.ego.bearing_delay = radar_dot::evaluation::kNuscenesBearingDelay;
  // The origin of the nuScenes base frame is the middle of the rear axle, which hardly slips.
  arguments.options.ego.filter_params.lateral_slip_std = 0.01;
  declare(app, arguments);
  declareObjects(app, arguments.options);
  declareMasks(app, arguments.options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_objects: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_objects: {}\n", error.what());
    return 1;
  }
}
