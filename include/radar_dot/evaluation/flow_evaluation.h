// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/evaluation_inputs.h"
#include "radar_dot/evaluation/flow_metrics.h"

namespace radar_dot::evaluation {

/// What is evaluated, and with which parameters.
struct FlowEvaluationOptions {
  /// Flow and truth are compared on the grid of its working_width. The truth is taken at the pixel nearest to
  /// each one of the grid. Errors are px of the full image on every grid. Initialisation "expected" starts
  /// from the flow of a static world by the depth below and the true motion of the vehicle; its depth is on
  /// the same grid.
  OpticalFlowConfig optical_flow;
  DepthConfig depth;
  EgoVelocityConfig ego_velocity;  ///< which returns depth sees
  PairOptions pairs;
  DepthInputOptions depth_input;

  /// Those that are in no section of a configuration file.
  void describe(FieldList& fields);
};

/// @throws InvalidParameter, also for what does not go together
void validate(const FlowEvaluationOptions& options);

/// Results of one scene, or of several merged by operator+=.
struct FlowReport {
  std::string scene;
  std::size_t pairs = 0;
  FlowErrors errors;
  /// Of each pair, from images in memory to flow on the grid; the start value of "expected" counts, its depth
  /// does not. Empty for flow "ground_truth" and "files".
  std::vector<double> seconds;

  /// "epe", "epe_median" (px of the full image), "fl" (KITTI's outliers, a fraction of the pixels with flow),
  /// "density" (their fraction of the pixels with truth) and counts of all, static and moving pixels;
  /// "ms_per_pair" (median).
  void describe(Figures& figures);
};

/// Evaluates the pairs of one scene of a simulated dataroot. Pixels that leave the second image or are
/// occluded in it take no part; what the images of the truth call moving counts as moving.
/// @throws dataset::DatasetError where there is no pair on disk, and for missing or unreadable files;
///         std::invalid_argument for invalid options.
FlowReport evaluateFlow(const dataset::Tables& tables, dataset::Index scene,
                        const FlowEvaluationOptions& options = {});

/// One pair of images with the true flow from the first to the second: KITTI's 16-bit PNG.
struct FlowPairFiles {
  std::filesystem::path first, second, truth;
};

/// Evaluates one pair, by a backend of makeOpticalFlow, on the grid of its working_width. All pixels with
/// truth take part; which ones move is not known. The time is that of a first call. The report is called as
/// the first image, without ending.
/// @throws dataset::DatasetError naming a file that cannot be read or is of another size than the first
///         image, and std::invalid_argument for invalid params: one pair has no flow to start
///         from.
FlowReport evaluateFlow(const FlowPairFiles& files, const OpticalFlowParams& params);

/// Plain-text table; the last row is the overall result. Errors in px of the full image, shares in %.
std::string formatTable(const std::vector<FlowReport>& scenes, const FlowReport& overall);

}  // namespace radar_dot::evaluation
