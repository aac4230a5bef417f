// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "radar_dot/vision/depth_estimator.h"

namespace radar_dot::tools {

/// Where depth comes from: options of the evaluators that need it.
inline void declareDepthSource(CLI::App& app, std::string& backend, std::string& directory,
                               std::vector<std::string>& radar_channels) {
  app.add_option("--depth", backend, "radar_ground, lidar, torch, ground_truth, noisy, files")
      ->capture_default_str();
  app.add_option("--depth-directory", directory, "Folder of 16-bit PNG depths, for --depth files");
  app.add_option("--depth-radars", radar_channels,
                 "Radars that depth sees, comma-separated (default: RADAR_FRONT for torch, else all)")
      ->delimiter(',');
}

/// How uncertain its backends say it is.
inline void declareDepthUncertainty(CLI::App& app, DepthParams& depth) {
  const auto share = [&app](const char* name, double& value, const char* what) {
    app.add_option(name, value, std::string("1 sigma, share of the inverse depth: ") + what)
        ->capture_default_str();
  };
  app.add_option("--ground-pitch-std", depth.ground_pitch_std, "rad, 1 sigma (radar_ground)")
      ->capture_default_str();
  app.add_option("--ground-height-std", depth.ground_height_std, "m, 1 sigma (radar_ground)")
      ->capture_default_str();
  share("--ground-relative-std", depth.ground_relative_std, "ground that is not flat (radar_ground)");
  share("--column-std", depth.column_std, "columns (radar_ground)");
  share("--background-std", depth.background_std, "background (radar_ground)");
  share("--lidar-std", depth.lidar_std, "at a point (lidar)");
  share("--completion-std", depth.completion_std,
        "for each px, at 1600 px width, to the nearest point (lidar)");
  share("--relative-std", depth.relative_std, "everywhere (torch, files)");
}

/// Parameters of its backends.
inline void declareDepthParams(CLI::App& app, DepthParams& depth) {
  app.add_option("--ground-pitch", depth.ground_pitch, "rad (radar_ground)")->capture_default_str();
  app.add_flag("--image-edges", depth.image_edges,
               "Move the borders of columns to edges of the image (radar_ground)");
  app.add_option("--column-height", depth.column_height, "m (radar_ground)")->capture_default_str();
  app.add_option("--column-half-width", depth.column_half_width, "m (radar_ground)")->capture_default_str();
  app.add_option("--background-depth", depth.background_depth, "m (radar_ground); 0 = unknown")
      ->capture_default_str();
  app.add_option("--background-angle", depth.background_angle, "rad (radar_ground)")->capture_default_str();
  app.add_option("--completion-kernel", depth.completion_kernel, "px (lidar)")->capture_default_str();
  declareDepthUncertainty(app, depth);
  app.add_option("--depth-model", depth.network.model,
                 "TorchScript file, of export_justdepth.py (--depth torch)");
}

/// The grid that flow, depth and masks are on.
inline void declareGrid(CLI::App& app, int& working_width) {
  app.add_option("--working-width", working_width, "px, grid of flow, depth and mask; 0 = the image's")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
}

}  // namespace radar_dot::tools
