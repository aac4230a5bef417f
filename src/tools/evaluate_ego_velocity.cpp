// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "result_files.h"
#include "scene_loop.h"

namespace {

using radar_dot::evaluation::VelocityEvaluationOptions;
using radar_dot::evaluation::VelocityReport;

constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot, version = "v1.0-mini", model = "planar_yaw";
  std::vector<std::string> scenes, mount_corrections;
  bool all_returns = false;
  bool paper_labels = false;
  radar_dot::tools::ResultFiles files;
  VelocityEvaluationOptions options;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--dataroot", arguments.dataroot, "Folder with the nuScenes tables and sensor files")
      ->required();
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str();
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channels", arguments.options.channels, "Radars, comma-separated (default: all)")
      ->delimiter(',');
  arguments.files.declare(app);
  app.add_option("--model", arguments.model, "Motion model of trajectory and labels")->capture_default_str();
  app.add_option("--doppler-scale", arguments.options.extraction.doppler_scale,
                 "Factor on every Doppler velocity")
      ->check(CLI::Range(-10.0, 10.0))
      ->capture_default_str();
  app.add_option(
         "--bearing-delay", arguments.options.bearing_delay,
         "s, by which the bearings of returns are later than their velocities; 0 for simulated scenes")
      ->check(CLI::Range(-1.0, 1.0))
      ->capture_default_str();
  app.add_option("--threshold", arguments.options.estimator.segmentation.threshold,
                 "tau of the two passes, m/s")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  radar_dot::EgoVelocityParams& estimator = arguments.options.estimator;
  app.add_option("--inlier-threshold", estimator.inlier_threshold, "RANSAC inlier residual, m/s")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  app.add_option("--iterations", estimator.ransac_iterations, "RANSAC hypotheses")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--seed", estimator.seed, "Seed of RANSAC")->capture_default_str();
  app.add_option("--doppler-std", estimator.doppler_std, "1 sigma of a Doppler velocity, m/s")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  app.add_option("--azimuth-std", estimator.azimuth_std, "1 sigma of a bearing, rad")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--mount-yaw-correction", arguments.mount_corrections,
                 "CHANNEL=RAD, comma-separated: added to the yaw of a mount")
      ->delimiter(',');
  app.add_option("--scan-std", estimator.scan_std, "1 sigma of what the returns of a scan share, m/s")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_flag("--all-returns", arguments.all_returns, "Switch the nuScenes validity filters off");
  app.add_flag("--paper-labels", arguments.paper_labels,
               "Label by the residual threshold alone, without neighbours");
}

void declareMasks(CLI::App& app, VelocityEvaluationOptions& options) {
  app.add_option(
      "--masks", options.mask_directory,
      "Folder of evaluate_segmentation --save-masks: returns in the newest mask at or before their "
      "scan are dynamic");
  app.add_option("--mask-channel", options.mask_channel, "Camera of the masks")->capture_default_str();
  app.add_option("--max-mask-age", options.max_mask_age, "s, from the image of a mask to the scan")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option(
         "--mask-delay", options.mask_delay,
         "s, from an image to the time its mask is known; 0.5 for masks of pairs of keyframes is what "
         "a vehicle has")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
}

void declareFilter(CLI::App& app, VelocityEvaluationOptions& options) {
  radar_dot::VelocityFilterParams& filter = options.filter_params;
  const auto add = [&app](const char* name, double& value, double lowest, double highest,
                          const char* meaning) {
    app.add_option(name, value, meaning)->check(CLI::Range(lowest, highest))->capture_default_str();
  };
  app.add_flag("--filter", options.filter, "Evaluate the causal filter over sweeps too");
  app.add_flag("!--filter-joint", options.filter_radars,
               "The filter takes the joint estimates alone, not each radar by itself");
  add("--filter-jerk", filter.longitudinal_jerk, 1e-3, 100.0, "Change of the acceleration per second, m/s^3");
  add("--filter-lateral-jerk", filter.lateral_jerk, 1e-3, 100.0, "The same of the sideslip velocity, m/s^3");
  add("--filter-curvature-rate", filter.curvature_rate, 1e-4, 10.0,
      "1 sigma of the yaw acceleration per m/s at low speed, 1/(m s)");
  add("--filter-yaw-jerk", filter.yaw_jerk, 1e-3, 100.0, "The same times the speed at high speed, m/s^3");
  add("--filter-yaw-time", filter.yaw_acceleration_time, 0.01, 100.0,
      "Correlation time of the yaw acceleration, s");
  add("--lateral-slip-std", filter.lateral_slip_std, 0.0, 1.0,
      "1 sigma of the slip angle at the rear axle, rad; 0 = nothing is assumed");
  add("--mount-yaw-std", filter.mount_yaw_std, 0.0, 1.0,
      "1 sigma of the yaw of the mounts, which the filter learns, rad; 0 = exact");
  add("--error-correlation", filter.error_correlation_time, 0.0, 10.0,
      "For how long the errors of a radar are alike, s");
}

/// "RADAR_FRONT=-0.012" -> {"RADAR_FRONT", -0.012}.
std::map<std::string, double> parseCorrections(const std::vector<std::string>& texts) {
  std::map<std::string, double> corrections;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    char* end = nullptr;
    const double value = equals == std::string::npos ? 0.0 : std::strtod(text.c_str() + equals + 1, &end);
    if (end == nullptr || *end != '\0' || end == text.c_str() + equals + 1) {
      throw std::invalid_argument(fmt::format("--mount-yaw-correction '{}' is not CHANNEL=RAD", text));
    }
    corrections[text.substr(0, equals)] = value;
  }
  return corrections;
}

int run(Arguments& arguments) {
  arguments.files.check();
  namespace dataset = radar_dot::dataset;
  VelocityEvaluationOptions& options = arguments.options;
  options.estimator.model = radar_dot::motionModelFromString(arguments.model);
  options.mount_yaw_corrections = parseCorrections(arguments.mount_corrections);
  options.estimator.segmentation.neighbourhood = !arguments.paper_labels;
  if (arguments.all_returns) {
    options.extraction.filter.invalid_states.clear();
    options.extraction.filter.ambig_states.clear();
    options.extraction.filter.pdh0_states.clear();
  }
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  const dataset::Tables tables = dataset::Tables::load(arguments.dataroot, load);

  const auto [reports, overall] =
      radar_dot::tools::evaluateScenes<VelocityReport, radar_dot::evaluation::NoRadarFiles>(
          "evaluate_ego_velocity", tables, !arguments.scenes.empty(), "radar files",
          [&options](const dataset::Tables& all, dataset::Index scene) {
            return evaluateEgoVelocity(all, scene, options);
          });
  for (const auto& [channel, counts] : overall.missing_files) {
    fmt::print(stderr,
               "evaluate_ego_velocity: warning: {}: {} of {} files are not on disk; evaluated the others\n",
               channel, counts.first, counts.second);
  }
  if (overall.frames == 0) {
    fmt::print(stderr, "evaluate_ego_velocity: warning: no pair of keyframes to compare with the poses\n");
  }
  arguments.files.write(reports, overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Scores the radar ego velocity, trajectory and static/dynamic labels on a nuScenes dataroot.");
  Arguments arguments;
  arguments.options.extraction.doppler_scale = radar_dot::evaluation::kNuscenesDopplerScale;
  // The origin of the nuScenes base frame is the middle of the rear axle, which hardly slips.
  arguments.options.filter_params.lateral_slip_std = 0.01;
  arguments.options.bearing_delay = radar_dot::evaluation::kNuscenesBearingDelay;
  declare(app, arguments);
  declareMasks(app, arguments.options);
  declareFilter(app, arguments.options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_ego_velocity: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_ego_velocity: {}\n", error.what());
    return 1;
  }
}
