// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/depth_metrics.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/vision/depth_estimator.h"

namespace radar_dot::evaluation {

/// What is evaluated, and with which parameters.
struct DepthEvaluationOptions {
  std::string channel = "CAM_FRONT";
  std::size_t max_images = 0;  ///< the first ones of each scene; 0 = all
  /// A backend of makeDepthEstimator, "ground_truth", "noisy" (see noisyDepth), or "files". The sigmas of the
  /// last three: kTrueDepthStd, noisyDepthStd, and DepthParams::relative_std.
  std::string depth = "radar_ground";
  /// Folder with <stem of the image>.png, for depth "files": 16-bit PNG, m * 256, 0 = unknown.
  std::string depth_directory;
  /// "ground_truth" of a simulated dataroot, or "lidar": every second point of each beam of the LIDAR_TOP
  /// sweep nearest to the image, the pixels it falls on. Depth "lidar" then sees only the other points. The
  /// sweep is moved to the time of the image as if the world were static, and what lidar sees beside an
  /// object that hides it from the camera stays in.
  std::string truth = "ground_truth";
  int working_width = 800;                        ///< px, of the grid of both depths; 0 = that of the images
  std::vector<std::string> radar_channels;        ///< empty = every radar of the scene
  std::vector<std::string> depth_radar_channels;  ///< see SegmentationEvaluationOptions
  ExtractionParams extraction;
  DepthParams depth_params;
};

/// Results of one scene, or of several merged by operator+=.
struct DepthReport {
  std::string scene;
  std::size_t images = 0;         ///< compared
  std::size_t without_truth = 0;  ///< on disk, but without a lidar sweep within 0.1 s, with truth "lidar"
  DepthErrors errors;

  DepthReport& operator+=(const DepthReport& other);
};

/// Evaluates the keyframe images of one scene.
/// @throws NoImages (segmentation_evaluation.h) where there are none, or none on disk,
///         dataset::DatasetError for missing or unreadable files, and std::invalid_argument for options that
///         are invalid.
DepthReport evaluateDepth(const dataset::Tables& tables, dataset::Index scene,
                          const DepthEvaluationOptions& options = {});

/// Plain-text table; the last row is the overall result. m, coverage as a share, and two quantiles of
/// NormalisedErrors: right sigmas give 0.674 and 1, too small ones more.
std::string formatTable(const std::vector<DepthReport>& scenes, const DepthReport& overall);
/// {"scenes": [{"scene", "images", "without_truth", "mae_50", "rmse_50" (m), "coverage_50" (share of the true
/// pixels), "true_pixels_50", "compared_50", and the same of 70 and 80 m, "sigma_median", "sigma_68"
/// (quantiles of NormalisedErrors)}], "overall": {same keys}}. Figures that do not exist are null.
std::string formatJson(const std::vector<DepthReport>& scenes, const DepthReport& overall);
/// The same as columns.
std::string formatCsv(const std::vector<DepthReport>& scenes, const DepthReport& overall);

}  // namespace radar_dot::evaluation
