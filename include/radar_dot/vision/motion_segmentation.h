// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot {

/// What makes a pixel's residual a score.
enum class MotionScore {
  kPaper,       ///< the paper's: residuals over one tolerance each, MADs above the median (motion_terms.h)
  kUncertainty  ///< Mahalanobis distance of the residuals, a chi-square level (uncertainty_terms.h)
};

/// Parameters of MotionSegmenter. Lengths in px are px of the camera's full image; on a coarser grid they are
/// scaled by MotionInput::pixel_scale.
struct MotionParams {
  MotionScore score = MotionScore::kPaper;

  // Score of the paper
  double k = 10.0;         ///< MADs above the median, the paper's k
  double lambda = 0.5;     ///< weight of the depth residual, the paper's lambda
  double min_depth = 1.0;  ///< m, the paper's Z_min: nearer pixels are tolerated like this depth
  double foe_std =
      100.0;  ///< px, the paper's sigma_FOE: reach of the extra tolerance around the focus of expansion
  /// Least threshold. A score of 2 is a residual of 4 px at the median depth: where nearly everything agrees,
  /// MADs above the median would cut into the errors of flow and depth.
  double min_threshold = 2.0;

  // Score by uncertainty, 1 sigma each
  double flow_std = 2.0;            ///< px, of each component of a flow
  double flow_std_relative = 0.03;  ///< share of the flow's length, on top
  double fb_error_weight = 0.2;      ///< weight of the forward-backward error, where available
  double depth_std = 0.2;           ///< share of the inverse depth, where MotionInput::depth_std does not say
  double next_depth_std = 0.5;      ///< share of the depth, of a depth seen in the second image
  /// Probability that a static pixel is above the threshold, were the uncertainties exact. What they leave
  /// out is measured in every image: the threshold grows and falls with the median of the score over that of
  /// static pixels,
  double false_alarm = 1e-3;
  double min_scale = 0.6;  ///< but not below this multiple
  /// Hysteresis: a region above the threshold counts where a part of it that stands the opening is above this
  /// multiple of it; 1 = off.
  double seed = 3.5;

  /// A predicted point farther than the depth seen there by this share of its own depth is hidden in the
  /// second image. Well above the depth errors, so that a mover that comes nearer is not taken for an
  /// occluder.
  double occlusion_margin = 0.5;
  double max_depth = 120.0;  ///< m; farther is unknown
  int opening = 5;           ///< px, diameter of the ellipse that removes isolated detections; 0 or 1 = off
  int closing = 9;           ///< px, diameter of the ellipse that fills gaps; 0 or 1 = off
  /// Excludes pixels whose prediction leaves the image, as the paper's "out of bounds": flow is worst there.
  /// With flow that knows itself what it cannot see (forward_backward, or exact), leave it off: a car that
  /// drives along stays in view where a standing one would have left it.
  bool predicted_in_view = true;
  /// Factor on the score within the footprint of dynamic radar returns is 1 + this; 0 = off. At 2 a third of
  /// the evidence is enough where the radar has seen something move; more finds more movers, and spills
  /// around them.
  double radar_gain = 2.0;
  double radar_radius = 1.0;       ///< m, of the footprint of a return
  double radar_azimuth_std = 0.0;  ///< rad; far away the footprint is as wide as one sigma of the bearing
  /// Divisor of the score within the footprint of static radar returns, and in that of none that moves, is 1
  /// + this; 0 = off.
  double static_gain = 0.0;
};
/// @throws std::invalid_argument naming the invalid parameter.
void validate(const MotionParams& params);

/// One pair of images, at t-1 and t, on one grid. Seen from the second image (motion_history.h) t is the
/// earlier time.
struct MotionInput {
  CameraIntrinsics camera;   ///< of the grid
  double pixel_scale = 1.0;  ///< px of the full image per px of the grid
  Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();  ///< staticPointMotion, m
  cv::Mat flow;        ///< CV_32FC2, px of the grid, from t-1 to t; NaN = unknown
  cv::Mat flow_valid;  ///< CV_8UC1, 0 = unreliable; empty: all are reliable
  /// CV_32FC1, px of the grid: the forward-backward error; empty or NaN: not known
  cv::Mat fb_error;
  cv::Mat depth;  ///< CV_32FC1, m, at t-1 (the paper's D_{t-1}); NaN, 0 or less = unknown
  /// CV_32FC1, 1 sigma of the inverse depth at t-1, share of it; empty, NaN or negative: MotionParams
  cv::Mat depth_std;
  cv::Mat next_depth;  ///< CV_32FC1, m, at t (the paper's D_t); empty: no depth residual anywhere
  std::vector<Eigen::Vector3f>
      dynamic_points;  ///< m, camera frame at t-1: dynamic radar returns, for radar_gain
  std::vector<Eigen::Vector3f> static_points;  ///< the same of static ones, for static_gain
  /// Of a small motion (omega, tau) after T_current_from_previous, X -> X + omega x X + tau: rad^2, rad m,
  /// m^2, camera frame at t. For the score by uncertainty.
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// CV_32FC1, log-odds that a pixel moves, from the images before (carriedBelief); NaN: nothing is known;
  /// empty: nowhere. For the score by uncertainty.
  cv::Mat belief;
};

/// Outcome of one pair, on the grid of the input. The images belong to the segmenter until its next call.
struct MotionResult {
  cv::Mat mask;   ///< CV_8UC1, 255 = moves independently
  cv::Mat valid;  ///< CV_8UC1, 255 = took part, 0 = excluded: no depth or flow, out of view, occluded
  cv::Mat score;  ///< CV_32FC1, S, or standard deviations from static; NaN where excluded
  double median_depth = 0.0;  ///< m, the paper's Z~
  double median = 0.0;        ///< of S
  double mad = 0.0;           ///< of S; 0 with the score by uncertainty
  double scale = 1.0;      ///< of scores over the uncertainties, min_scale or more; 1 with the paper's score
  double threshold = 0.0;  ///< tau
  std::size_t valid_count = 0;
};

/// The paper's dynamic mask in one fused pass over the image, on all cores TBB gives.
///
/// A static point at depth D under pixel p of frame t-1 appears at p' in frame t. Where the flow leads
/// elsewhere, or the depth found at p' is another one, the pixel moves independently: its score
///     S = e_flow / sigma_flow + lambda e_depth / sigma_depth
/// lies above median(S) + k MAD(S). The terms are in motion_terms.h. Where D_t is unknown at p' there is no
/// depth residual, and the flow decides alone. Pixels without depth or reliable flow, those whose flow leaves
/// the image, whose prediction falls behind the camera (or outside of the image, see predicted_in_view), and
/// those occluded in frame t take part in neither the median nor the mask.
class MotionSegmenter {
 public:
  /// @throws std::invalid_argument as validate().
  explicit MotionSegmenter(MotionParams params = {});
  ~MotionSegmenter();
  MotionSegmenter(MotionSegmenter&&) noexcept;
  MotionSegmenter& operator=(MotionSegmenter&&) noexcept;

  /// @param before  the first image together with the one before it, seen from the first image
  ///                (seenFromSecond), with the same camera, depth and returns; or null. A pixel that the
  ///                second image does not show any more, or whose flow is wrong, may be seen well there. Its
  ///                score is the root mean square of the two, each over its own scale; or the one that there
  ///                is. The threshold stays that of one: their errors are partly the same. Score by
  ///                uncertainty only.
  /// @throws std::invalid_argument for images of other types or sizes than the camera's grid, and `before` or
  ///         a belief with the paper's score.
  const MotionResult& segment(const MotionInput& input, const MotionInput* before = nullptr);
  const MotionParams& params() const noexcept { return params_; }

 private:
  struct Workspace;
  MotionParams params_;
  std::unique_ptr<Workspace> workspace_;
};

/// Flow of a static world, CV_32FC2 on the grid of `camera` in its px; NaN without depth or behind the
/// camera.
cv::Mat expectedFlow(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous,
                     const cv::Mat& depth);

}  // namespace radar_dot
