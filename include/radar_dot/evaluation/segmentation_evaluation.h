// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/annotation_labels.h"
#include "radar_dot/evaluation/mask_age.h"
#include "radar_dot/evaluation/mean.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot::evaluation {

/// What is evaluated, and with which parameters.
struct SegmentationEvaluationOptions {
  std::string channel = "CAM_FRONT";
  /// "keyframes": a keyframe and the next one, as in the paper; "next": a keyframe and the image after it.
  std::string pairs = "keyframes";
  std::size_t max_pairs = 0;  ///< the first ones of each scene; 0 = all
  /// A backend of makeOpticalFlow, "ground_truth" (of a simulated dataroot), or "files".
  std::string flow = "dis";
  /// A backend of makeDepthEstimator, "ground_truth", "noisy" (ground truth with the errors of a depth
  /// network, see noisyDepth), or "files".
  std::string depth = "radar_ground";
  /// Folder with <stem of the first image>.png, for flow "files": KITTI's 16-bit PNG, px of its own grid.
  std::string flow_directory;
  /// Folder with <stem of the image>.png, for depth "files": 16-bit PNG, m * 256, 0 = unknown.
  std::string depth_directory;
  /// "radar": mean over the interval; "radar_start": at its begin, as in the paper; "ground_truth".
  std::string velocity = "radar";
  std::string rotation = "ground_truth";  ///< "ground_truth" (as in the paper), "radar"
  int working_width = 800;                ///< px, of the grid of flow, depth and mask; 0 = that of the images
  std::vector<std::string> radar_channels;  ///< empty = every radar of the scene
  /// Those of them that depth sees; empty = RADAR_FRONT for the backend "torch", whose networks are trained
  /// with it, and all for the others.
  std::vector<std::string> depth_radar_channels;
  ExtractionParams extraction;
  /// s, by which the bearings of returns are later than their velocities, as in EgoVelocityEvaluationOptions.
  double bearing_delay = 0.0;
  EgoVelocityParams estimator;
  OpticalFlowParams optical_flow;
  DepthParams depth_params;
  MotionParams motion;
  MotionUncertainty motion_uncertainty;  ///< for the score by uncertainty, and for `refine`
  bool refine = false;                   ///< the motion by the image (refineMotion), and the ground by it
  RefinementParams refinement;
  /// MotionInput::depth_std is what the depth declares (see DepthEvaluationOptions::depth), not a constant.
  /// For the score by uncertainty, and for `refine`.
  bool depth_uncertainty = false;
  /// The first image is also seen together with the one before it (MotionSegmenter::segment): the keyframe
  /// before, or with pairs "next" the previous image. Needs a flow backend and the score by uncertainty.
  bool look_back = false;
  /// s, after which a belief is worth 1 / e: what the latest mask says of a pixel is carried to the next one
  /// (carriedBelief), where the latest pair ends with the first image of the next. 0 = off. Needs a flow
  /// backend and the score by uncertainty.
  double memory = 0.0;
  /// Movers whose residual of the true flow is smaller do not count (neither right nor wrong), px of the full
  /// image; nor do road users that move too slowly for their annotation to say so. 0 = all count. Needs the
  /// ground truth of a simulated dataroot.
  double min_true_residual = 0.0;
  /// The paper's loop from image to radar: returns that lie in the latest mask of the scene are known to move
  /// in the velocity estimates of the pairs after it. They are brought from their scan to the time of the
  /// mask's image with the velocity estimated last. Not with velocity "ground_truth".
  bool mask_to_velocity = false;
  double max_mask_age = kMaxMaskAge;  ///< s, from the image of a mask to the scan
  std::string mask_directory;         ///< <stem of the first image>.png of every mask; empty = not saved
};

/// Results of one scene, or of several merged by operator+=. Counts are pixels of all pairs.
struct SegmentationReport {
  std::string scene;
  std::size_t frames = 0;          ///< pairs
  std::size_t without_motion = 0;  ///< of them, refused by the velocity estimator: their mask is empty
  Confusion pixels;
  double seconds = 0.0;  ///< of the fused mask computation, summed over the pairs
  /// m/s, over the pairs with an estimate: |v - v_true| in the plane, v_true as PoseTrack::meanVelocity of
  /// the pair. v is the mean estimate over the pair, or with velocity "radar_start" the one at its begin.
  /// Empty with velocity "ground_truth".
  Mean velocity_error;

  double iou() const;                 ///< TP / (TP + FP + FN); NaN when there is neither mask nor truth
  double falsePositiveShare() const;  ///< FP / (FP + TN): of the pixels that do not move
  SegmentationReport& operator+=(const SegmentationReport& other);
};

/// None of the image pairs a scene needs is on disk.
class NoImages : public dataset::DatasetError {
 public:
  using DatasetError::DatasetError;
};

/// Evaluates one scene. `progress` is called after every pair with (done, all).
/// @throws NoImages where a scene has no pair of images on disk, dataset::DatasetError for missing or
/// unreadable files, and std::invalid_argument for options that make
///         no sense.
SegmentationReport evaluateSegmentation(const dataset::Tables& tables, dataset::Index scene,
                                        const std::vector<const dataset::InstanceMask*>& masks,
                                        const SegmentationEvaluationOptions& options = {},
                                        const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Plain-text table in the form of the paper's Table I; the last row is the overall result.
std::string formatTable(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall);
/// {"scenes": [{"scene", "iou", "precision", "recall", "f1", "false_positive_share", "velocity_error" (m/s),
/// "frames", "without_motion", "true_positives", "false_positives", "false_negatives", "true_negatives",
/// "velocity_error_count", "seconds", "velocity_error_sum"}], "overall": {same keys}}. Figures that do not
/// exist are null.
std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall);
/// The same as columns.
std::string formatCsv(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall);

/// Reads files of formatJson and gives their scenes in order of their names.
/// @throws std::runtime_error naming file and field for what is no such file, and naming both files for a
///         scene that stands in two of them.
std::vector<SegmentationReport> mergeJson(const std::vector<std::string>& files);

}  // namespace radar_dot::evaluation
