// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "progress_bar.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "result_files.h"
#include "signal_watch.h"

namespace {

namespace dataset = radar_dot::dataset;
using radar_dot::evaluation::SegmentationEvaluationOptions;
using radar_dot::evaluation::SegmentationReport;

constexpr int kUsage = 2;

struct Arguments {
  std::string dataroot, version = "v1.0-mini";
  std::vector<std::string> scenes, merge;
  int jobs = 1;
  radar_dot::tools::ResultFiles files;
  SegmentationEvaluationOptions options;
};

void declareInputs(CLI::App& app, Arguments& arguments) {
  SegmentationEvaluationOptions& options = arguments.options;
  app.add_option("--dataroot", arguments.dataroot,
                 "Folder with the nuScenes tables and sensor files; needed without --merge");
  app.add_option("--version", arguments.version, "Table folder")->capture_default_str();
  app.add_option("--scenes", arguments.scenes, "Scene names, comma-separated (default: all)")->delimiter(',');
  app.add_option("--channel", options.channel, "Camera")->capture_default_str();
  app.add_option("--radars", options.radar_channels, "Radars, comma-separated (default: all)")
      ->delimiter(',');
  app.add_option("--pairs", options.pairs,
                 "keyframes: to the next keyframe (the paper); next: to the next image")
      ->capture_default_str();
  app.add_option("--max-pairs", options.max_pairs, "The first ones of each scene; 0 = all")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str();
  app.add_option("--flow", options.flow, "dis, ground_truth, files")->capture_default_str();
  app.add_option("--flow-directory", options.flow_directory, "Folder of 16-bit PNG flows, for --flow files");
  app.add_option("--depth", options.depth, "radar_ground, lidar, ground_truth, noisy, files")
      ->capture_default_str();
  app.add_option("--depth-directory", options.depth_directory,
                 "Folder of 16-bit PNG depths, for --depth files");
  app.add_option("--velocity", options.velocity, "radar, radar_start, ground_truth")->capture_default_str();
  app.add_option("--rotation", options.rotation, "ground_truth (the paper), radar")->capture_default_str();
  app.add_option("--working-width", options.working_width,
                 "px, grid of flow, depth and mask; 0 = the image's")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.add_option("--doppler-scale", options.extraction.doppler_scale, "Factor on every Doppler velocity")
      ->check(CLI::Range(-10.0, 10.0))
      ->capture_default_str();
  app.add_option(
         "--min-true-residual", options.min_true_residual,
         "px; movers whose true flow differs less from a static world's, or that the second image does not "
         "show, do not count. Needs ground truth")
      ->capture_default_str();
}

void declareMethod(CLI::App& app, SegmentationEvaluationOptions& options) {
  radar_dot::MotionParams& motion = options.motion;
  app.add_option("--k", motion.k, "MADs above the median")->capture_default_str();
  app.add_option("--lambda", motion.lambda, "Weight of the depth residual")->capture_default_str();
  app.add_option("--min-depth", motion.min_depth, "Z_min, m")->capture_default_str();
  app.add_option("--foe-std", motion.foe_std, "sigma_FOE, px")->capture_default_str();
  app.add_option("--occlusion-margin", motion.occlusion_margin, "Share of the depth that counts as hidden")
      ->capture_default_str();
  app.add_option("--max-depth", motion.max_depth, "m; farther is unknown")->capture_default_str();
  app.add_option("--opening", motion.opening, "px")->capture_default_str();
  app.add_option("--closing", motion.closing, "px")->capture_default_str();
  app.add_option("--min-threshold", motion.min_threshold, "Least threshold of the score")
      ->capture_default_str();
  app.add_flag("--predicted-in-view,!--no-predicted-in-view", motion.predicted_in_view,
               "Exclude pixels whose prediction leaves the image (default: on)");
  app.add_option("--radar-gain", motion.radar_gain,
                 "Dynamic returns raise the score by this factor, less 1; 0 = off")
      ->capture_default_str();
  app.add_option("--radar-radius", motion.radar_radius, "m, around a dynamic return")->capture_default_str();
  radar_dot::OpticalFlowParams& flow = options.optical_flow;
  app.add_option("--preset", flow.preset, "ultrafast, fast, medium, fine (dis)")->capture_default_str();
  app.add_option("--initialisation", flow.initialisation, "none, expected (flow of a static world)")
      ->capture_default_str();
  app.add_flag("--forward-backward,!--no-forward-backward", flow.forward_backward,
               "Exclude pixels whose flow there and back does not close (default: off)");
  radar_dot::DepthParams& depth = options.depth_params;
  app.add_option("--ground-pitch", depth.ground_pitch, "rad (radar_ground)")->capture_default_str();
  app.add_flag("--image-edges", depth.image_edges,
               "Move the borders of columns to edges of the image (radar_ground)");
  app.add_option("--column-height", depth.column_height, "m (radar_ground)")->capture_default_str();
  app.add_option("--column-half-width", depth.column_half_width, "m (radar_ground)")->capture_default_str();
  app.add_option("--background-depth", depth.background_depth, "m (radar_ground); 0 = unknown")
      ->capture_default_str();
  app.add_option("--background-angle", depth.background_angle, "rad (radar_ground)")->capture_default_str();
  app.add_option("--completion-kernel", depth.completion_kernel, "px (lidar)")->capture_default_str();
}

void declareOutputs(CLI::App& app, Arguments& arguments) {
  arguments.files.declare(app);
  app.add_option("--save-masks", arguments.options.mask_directory, "Write every mask to this folder, as PNG");
  app.add_option("--jobs", arguments.jobs, "Scenes at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--merge", arguments.merge,
                 "Results of other runs (--json) that become one table; nothing is run")
      ->excludes("--dataroot");
}

/// Scenes on some threads; results in the order of the tables.
class Runner {
 public:
  Runner(const dataset::Tables& tables, const std::vector<dataset::InstanceMask>& masks,
         const Arguments& arguments)
      : tables_(tables),
        arguments_(arguments),
        by_scene_(tables.scenes.size()),
        results_(tables.scenes.size()),
        progress_(tables.scenes.size(), {0, 0}),
        bar_("segmenting", "pairs") {
    for (const dataset::InstanceMask& mask : masks) {
      const dataset::Index reading = tables.findReading(mask.sample_data_token);
      const dataset::SampleData& data = tables.sample_data[static_cast<std::size_t>(reading)];
      const dataset::Index scene = tables.samples[static_cast<std::size_t>(data.sample)].scene;
      by_scene_[static_cast<std::size_t>(scene)].push_back(&mask);
    }
  }

  std::vector<SegmentationReport> run() {
    std::vector<std::thread> threads;
    const std::size_t jobs = std::min(static_cast<std::size_t>(arguments_.jobs), results_.size());
    for (std::size_t i = 0; i < jobs; ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    if (error_) std::rethrow_exception(error_);
    std::vector<SegmentationReport> reports;
    for (std::optional<SegmentationReport>& result : results_)
      if (result) reports.push_back(std::move(*result));
    return reports;
  }
  /// One line for each scene that has no images.
  const std::vector<std::string>& leftOut() const { return left_out_; }

 private:
  void work() {
    for (std::size_t scene = next_++; scene < results_.size() && !failed_; scene = next_++) {
      try {
        results_[scene] =
            evaluateSegmentation(tables_, static_cast<dataset::Index>(scene), by_scene_[scene],
                                 arguments_.options, [this, scene](std::size_t done, std::size_t all) {
                                   signals_.check();  // between pairs, where no mask is half written
                                   report(scene, done, all);
                                 });
      } catch (const radar_dot::evaluation::NoImages& error) {
        // A dataroot may hold a part of the scenes; one that was asked for must be there.
        if (!arguments_.scenes.empty() || results_.size() == 1) {
          fail();
        } else {
          const std::lock_guard<std::mutex> lock(mutex_);
          left_out_.emplace_back(error.what());
        }
      } catch (...) {
        fail();
      }
    }
  }
  void fail() {
    const std::lock_guard<std::mutex> lock(mutex_);
    failed_ = true;
    if (!error_) error_ = std::current_exception();
  }
  void report(std::size_t scene, std::size_t done, std::size_t all) {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_[scene] = {done, all};
    // Scenes that have not begun are taken to be as long as this one.
    std::size_t sum = 0;
    std::size_t total = 0;
    for (const auto& [so_far, pairs] : progress_) {
      sum += so_far;
      total += pairs == 0 ? all : pairs;
    }
    bar_.update(sum, total);
  }

  const dataset::Tables& tables_;
  const Arguments& arguments_;
  radar_dot::tools::SignalWatch signals_;
  std::vector<std::vector<const dataset::InstanceMask*>> by_scene_;
  std::vector<std::optional<SegmentationReport>> results_;
  std::vector<std::pair<std::size_t, std::size_t>> progress_;  // done, all; by scene
  std::vector<std::string> left_out_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
  std::mutex mutex_;
  radar_dot::tools::ProgressBar bar_;
};

std::vector<SegmentationReport> evaluateAll(const Arguments& arguments) {
  dataset::LoadOptions load;
  load.version = arguments.version;
  load.scenes = arguments.scenes;
  dataset::Tables tables = dataset::Tables::load(arguments.dataroot, load);
  if (!dataset::hasInstanceMasks(tables)) {
    throw std::runtime_error(
        fmt::format("{}/{}/nuinsseg.json: is not there; get nuInsSeg for the masks of nuScenes, or simulate "
                    "(simulate_drive)",
                    arguments.dataroot, arguments.version));
  }
  const std::vector<dataset::InstanceMask> masks = dataset::readInstanceMasks(tables);
  if (!arguments.options.mask_directory.empty())
    std::filesystem::create_directories(arguments.options.mask_directory);
  Runner runner(tables, masks, arguments);
  std::vector<SegmentationReport> reports = runner.run();
  for (const std::string& line : runner.leftOut())
    fmt::print(stderr, "evaluate_segmentation: warning: left out {}\n", line);
  if (reports.empty()) throw std::runtime_error(arguments.dataroot + ": no scene has images on disk");
  return reports;
}

int run(const Arguments& arguments) {
  arguments.files.check();
  const std::vector<SegmentationReport> reports =
      arguments.merge.empty() ? evaluateAll(arguments) : radar_dot::evaluation::mergeJson(arguments.merge);
  SegmentationReport overall;
  for (const SegmentationReport& report : reports) overall += report;
  arguments.files.write(reports, overall);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Scores dynamic masks against nuInsSeg on a nuScenes dataroot, as the paper's Table I.");
  Arguments arguments;
  // Half a second between keyframes is more than flow finds from nothing.
  arguments.options.optical_flow.initialisation = "expected";
  arguments.options.extraction.doppler_scale = radar_dot::evaluation::kNuscenesDopplerScale;
  declareInputs(app, arguments);
  declareMethod(app, arguments.options);
  declareOutputs(app, arguments);
  try {
    app.parse(argc, argv);
    if (arguments.dataroot.empty() && arguments.merge.empty())
      throw CLI::RequiredError("--dataroot (or --merge)");
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "evaluate_segmentation: {} (see --help)\n", error.what());
    return kUsage;
  }
  try {
    return run(arguments);
  } catch (const radar_dot::tools::Interrupted& interrupt) {
    fmt::print(stderr, "evaluate_segmentation: interrupted; no results are written\n");
    return radar_dot::tools::kSignalBase + interrupt.signal;
  } catch (const std::exception& error) {
    fmt::print(stderr, "evaluate_segmentation: {}\n", error.what());
    return 1;
  }
}
