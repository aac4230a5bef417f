// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/depth_metrics.h"
#include "radar_dot/evaluation/evaluation_inputs.h"

namespace radar_dot::evaluation {

/// What depth is compared with.
enum class DepthTruth { kAuto, kGroundTruth, kLidar };

/// What is evaluated, and with which parameters.
struct DepthEvaluationOptions {
  /// Both depths are on the grid of its working_width. The sigmas of the sources that are no backends:
  /// kTrueDepthStd of ground_truth, noisyDepthStd of noisy, and relative_std of files.
  DepthConfig depth;
  EgoVelocityConfig ego_velocity;        ///< which returns depth sees, and with backend motion the velocity
  OpticalFlowConfig optical_flow;        ///< of backend motion, on the same grid
  MotionUncertainty motion_uncertainty;  ///< for backend motion
  DepthInputOptions depth_input;
  std::vector<std::string> radar_channels;
  std::string camera = "CAM_FRONT";
  std::size_t max_images = 0;
  DepthTruth truth = DepthTruth::kAuto;
  double after = 0.0;
  bool static_only = false;

  /// Those that are in no section of a configuration file.
  void describe(FieldList& fields);
};

/// @throws InvalidParameter, also for what does not go together
void validate(const DepthEvaluationOptions& options);

/// The truth that a dataroot has, where it is to be chosen.
DepthTruth truthOf(const DepthEvaluationOptions& options, const std::filesystem::path& dataroot);

/// Results of one scene, or of several merged by operator+=.
struct DepthReport {
  std::string scene;
  std::size_t images = 0;         ///< compared
  std::size_t without_truth = 0;  ///< on disk, but without a lidar sweep within 0.1 s, with truth "lidar"
  DepthErrors errors;

  /// "mae", "rmse" (m), "coverage" (fraction of the true pixels) and counts within 50, 70 and 80 m;
  /// "sigma_median" and "sigma_68" (quantiles of NormalisedErrors).
  void describe(Figures& figures);
};

/// Evaluates the keyframe images of one scene.
/// @throws dataset::DatasetError where there are none on disk, and for missing or unreadable files;
///         std::invalid_argument for options that are invalid.
DepthReport evaluateDepth(const dataset::Tables& tables, dataset::Index scene,
                          const DepthEvaluationOptions& options = {});

/// Plain-text table; the last row is the overall result. m, coverage as a share, and two quantiles of
/// NormalisedErrors: right sigmas give 0.674 and 1, too small ones more.
std::string formatTable(const std::vector<DepthReport>& scenes, const DepthReport& overall);

}  // namespace radar_dot::evaluation

namespace radar_dot {

template <>
struct EnumNames<evaluation::DepthTruth> {
  static constexpr EnumName<evaluation::DepthTruth> kValues[] = {
      {evaluation::DepthTruth::kAuto, "auto", "ground_truth where the dataroot has it, else lidar"},
      {evaluation::DepthTruth::kGroundTruth, "ground_truth", "of a simulated dataroot"},
      {evaluation::DepthTruth::kLidar, "lidar",
       "every second point of each beam of the nearest LIDAR_TOP sweep, moved to the time of the image as if "
       "the world were static; depth_backend lidar sees only the other points"}};
};

}  // namespace radar_dot
