// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/vision/motion_depth.h"
#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/optical_flow.h"
#include "radar_dot/vision/recent_scans.h"

namespace radar_dot {

/// Parameters of MaskPipeline.
struct MaskPipelineParams {
  MotionParams motion;
  double radar_min_residual = 0.6;
  bool use_depth_uncertainty = false;
  MotionUncertainty motion_uncertainty;
  bool refine = false;
  bool refine_ground = false;
  GroundParams ground;
  RefinementParams refinement;
  bool motion_depth = false;
  bool look_back = false;
  double memory = 0.0;
  std::string ignore_mask;

  bool byUncertainty() const { return motion.score == MotionScore::kUncertainty; }
  bool looksBack() const { return byUncertainty() && look_back; }
  bool remembers() const { return byUncertainty() && memory > 0.0; }
  bool usesDepthUncertainty() const { return use_depth_uncertainty && (byUncertainty() || refine); }
  bool usesNextDepth() const { return byUncertainty() || motion.paper.lambda > 0.0; }
  bool followsDepth() const { return byUncertainty() && motion_depth; }
  bool usesBackwardFlow() const { return looksBack() || remembers() || followsDepth(); }
  void describe(FieldList& fields);
};
/// @throws InvalidParameter, also where ignore_mask cannot be read
void validate(const MaskPipelineParams& params);

/// Two images, their flow and depths on one grid, and the vehicle's motion between them. Images are read
/// during the call only.
struct MaskPair {
  double first_time = 0.0;   ///< s, of the image that flow and mask lie on
  double second_time = 0.0;  ///< s, of the other one; earlier where the flow runs backward in time
  CameraIntrinsics camera;   ///< of the grid
  double pixel_scale = 1.0;  ///< px of the full image per px of the grid
  FlowField flow;            ///< from the first image to the second
  cv::Mat depth;             ///< CV_32FC1, m, of the first image; NaN = unknown
  cv::Mat depth_std;         ///< as MotionInput::depth_std; may be empty
  cv::Mat next_depth;        ///< CV_32FC1, m, of the second image; may be empty
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_first_from_second = Eigen::Isometry3d::Identity();  ///< of the base
  MotionUncertainty motion_uncertainty;                                   ///< of that motion
  std::vector<CloudPoint> dynamic_points, static_points;  ///< radar returns, base frame at first_time
  bool wants_motion_depth = false;  ///< MaskOutcome::motion_depth, also where masks do not follow depth
};

/// What came of a pair.
struct MaskOutcome {
  MotionInput input;  ///< as it was scored: refined motion and depth
  MotionResult result;
  /// At the first image, from input.depth on as it was before: with motion_depth, or where it is wanted.
  std::optional<MotionDepthResult> motion_depth;
  bool looked_back = false;         ///< the previous pair took part
  double refinement_seconds = 0.0;  ///< that the refinement took
  double rotation_weight = 1.0;     ///< RefinedMotion::rotation_weight
};

/// Dynamic masks of a stream of image pairs: uncertainty of the motion, refinement by the image, radar
/// evidence, the previous pair and the memory of earlier masks around MotionSegmenter.
class MaskPipeline {
 public:
  /// @throws InvalidParameter, also where ignore_mask cannot be read
  explicit MaskPipeline(const MaskPipelineParams& params = {});
  /// Earlier pairs are forgotten where these would have scored them differently. @throws InvalidParameter
  void configure(const MaskPipelineParams& params);
  const MaskPipelineParams& params() const noexcept { return params_; }

  /// Flow from the second image of a pair to its first, which look_back, memory and motion depth of the next
  /// pair need.
  /// Copied. @param from, to  s, times of its images
  void addBackward(double from, double to, const FlowField& flow);
  /// The mask of a pair. Pairs come in the order of time.
  /// @throws std::invalid_argument for images of other types or sizes than the camera's grid, or of another
  /// shape than ignore_mask
  MaskOutcome process(const MaskPair& pair);
  void clear();

 private:
  struct Backward {
    double from = 0.0, to = 0.0;  // s
    FlowField field;
  };
  struct Previous {
    double first_time = 0.0, second_time = 0.0;
    MotionInput input;  // without what only its own image needs
    cv::Mat log_odds;   // at its first image
  };
  MotionInput inputOf(const MaskPair& pair) const;
  const cv::Mat& ignoredOn(const cv::Size& grid);
  double refine(MotionInput& input) const;
  const FlowField* backwardTo(const MaskPair& pair) const;
  cv::Mat beliefFor(const MaskPair& pair, const FlowField* backward) const;
  cv::Mat priorStd(const MotionInput& input) const;
  MotionDepthResult followDepth(const MaskPair& pair, const FlowField* backward, const MotionInput& input);
  void takeDepth(const MotionDepthResult& followed, MotionInput& input) const;
  void remember(const MaskPair& pair, const MaskOutcome& outcome);

  MaskPipelineParams params_;
  MotionSegmenter segmenter_;
  cv::Mat ignored_, ignored_on_grid_;  // CV_8UC1, not 0: as in the file; empty: nothing
  std::deque<Backward> backward_;
  std::optional<Previous> previous_;
  MotionDepth depth_;
};

}  // namespace radar_dot
