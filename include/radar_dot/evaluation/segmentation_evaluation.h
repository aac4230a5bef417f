// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/annotation_labels.h"
#include "radar_dot/evaluation/evaluation_inputs.h"
#include "radar_dot/evaluation/figures.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot::evaluation {

/// Velocity of the vehicle between the images of a pair.
enum class VelocitySource { kRadar, kRadarStart, kGroundTruth };
/// Rotation of the vehicle between the images of a pair.
enum class RotationSource { kGroundTruth, kRadar };

/// What is evaluated, and with which parameters.
struct SegmentationEvaluationOptions {
  EgoVelocityConfig ego_velocity;
  OpticalFlowConfig optical_flow;
  DepthConfig depth;
  DynamicSegmentationConfig segmentation;

  PairOptions pairs;
  DepthInputOptions depth_input;
  std::vector<std::string> radar_channels;
  VelocitySource velocity = VelocitySource::kRadar;
  RotationSource rotation = RotationSource::kGroundTruth;
  double min_true_residual = 0.0;
  /// The paper's loop from image to radar: returns that lie in the latest mask of the scene are known to move
  /// in the velocity estimates of the pairs after it. They are brought from their scan to the time of the
  /// mask's image by the velocities since.
  bool mask_to_velocity = false;
  std::string mask_directory;

  /// Those that are in no section of a configuration file.
  void describe(FieldList& fields);
};
/// @throws InvalidParameter, also for what does not go together
void validate(const SegmentationEvaluationOptions& options);

/// Results of one scene, or of several merged by operator+=. Counts are pixels of all pairs.
struct SegmentationReport {
  std::string scene;
  std::size_t frames = 0;          ///< pairs
  std::size_t without_motion = 0;  ///< of them, refused by the velocity estimator: their mask is empty
  Confusion pixels;
  /// px^4, sums over the pairs of products of intersection and union of mask and truth, for iouError
  double intersection_squared = 0.0, intersection_by_union = 0.0, union_squared = 0.0;
  std::size_t people_pixels = 0, people_found = 0;  ///< of people who move; found: in the mask
  double seconds = 0.0;                             ///< of the fused mask computation, summed over the pairs
  /// m/s, over the pairs with an estimate: |v - v_true| in the plane, v_true as PoseTrack::meanVelocity of
  /// the pair. v is the mean estimate over the pair, or with velocity "radar_start" the one at its begin.
  /// Empty with velocity "ground_truth".
  Mean velocity_error;

  double iou() const;  ///< TP / (TP + FP + FN); NaN when there is neither mask nor truth
  /// 1 sigma of iou() as one of pairs that are independent of each other, by linearisation of a ratio of sums
  /// (Cochran, Sampling Techniques, 1977, eq. 6.13): what a bootstrap over the pairs gives. NaN for less than
  /// two.
  double iouError() const;
  double falsePositiveShare() const;       ///< FP / (FP + TN): of the pixels that do not move
  void addPair(const Confusion& of_pair);  ///< to the pixels and their products
  /// "velocity_error" is m/s, "seconds" and "velocity_error_sum" are sums.
  void describe(Figures& figures);
};

/// Evaluates one scene. `progress` is called after every pair with (done, all).
/// @throws dataset::DatasetError where the scene has no pair of images on disk, or masks of other cameras
/// alone, and
///         for missing or unreadable files; std::invalid_argument for invalid options.
SegmentationReport evaluateSegmentation(const dataset::Tables& tables, dataset::Index scene,
                                        const std::vector<const dataset::InstanceMask*>& masks,
                                        const SegmentationEvaluationOptions& options = {},
                                        const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Plain-text table in the form of the paper's Table I; the last row is the overall result.
std::string formatTable(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall);

}  // namespace radar_dot::evaluation

namespace radar_dot {

template <>
struct EnumNames<evaluation::VelocitySource> {
  static constexpr EnumName<evaluation::VelocitySource> kValues[] = {
      {evaluation::VelocitySource::kRadar, "radar", "mean of the estimates over the pair"},
      {evaluation::VelocitySource::kRadarStart, "radar_start", "the estimate at its begin, as in the paper"},
      {evaluation::VelocitySource::kGroundTruth, "ground_truth", "displacement of the poses"}};
};

template <>
struct EnumNames<evaluation::RotationSource> {
  static constexpr EnumName<evaluation::RotationSource> kValues[] = {
      {evaluation::RotationSource::kGroundTruth, "ground_truth", "of the poses, as in the paper"},
      {evaluation::RotationSource::kRadar, "radar", "yaw rate of the estimates"}};
};

}  // namespace radar_dot
