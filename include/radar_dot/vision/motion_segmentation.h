// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/flow_depth_noise.h"
#include "radar_dot/vision/ground_plane.h"
#include "radar_dot/vision/recent_scans.h"
#include "radar_dot/vision/shared_fields.h"

namespace radar_dot {

/// What makes a pixel's residual a score.
enum class MotionScore {
  kPaper,       // motion_terms.h
  kUncertainty  // uncertainty_terms.h
};
template <>
struct EnumNames<MotionScore> {
  static constexpr EnumName<MotionScore> kValues[] = {
      {MotionScore::kPaper, "paper", "residuals over one tolerance each, MADs above the median"},
      {MotionScore::kUncertainty, "uncertainty",
       "Mahalanobis distance from the static prediction, a chi-square quantile"}};
};

// Lengths in px are px of the camera's full image; on a coarser grid they are scaled by
// MotionInput::pixel_scale.

/// Of the paper's score, with its symbols.
struct PaperScoreParams {
  double k = 10.0;
  double lambda = 0.5;
  double min_depth = 1.0;
  double foe_std = 100.0;
  double min_threshold = 2.0;

  void describe(FieldList& fields) {
    fields.add("k", k, "MADs above the median score that make a pixel dynamic, the paper's k (score paper)",
               "", {0.0, 1000.0});
    fields.add(
        "lambda", lambda,
        "Weight of the depth residual, the paper's lambda; 0: flow alone, without waiting for the depth of "
        "the second image (score paper)",
        "", {0.0, 100.0});
    fields.add("min_depth", min_depth,
               "Z_min of the paper: nearer pixels have the tolerance of this depth (score paper)", "m",
               {0.01, 100.0});
    fields.add(
        "foe_std", foe_std,
        "sigma_FOE of the paper: reach of the extra tolerance around the focus of expansion (score paper)",
        "px", {0.1, 10000.0});
    fields.add("min_threshold", min_threshold, "Lower limit of the threshold (score paper)", "",
               {0.0, 1000.0});
  }
};

/// Of the score by uncertainty.
struct UncertaintyScoreParams {
  FlowDepthNoise noise;
  double next_depth_std = 0.5;
  double false_alarm = 2e-3;
  double min_scale = 0.6;
  double hysteresis_ratio = 1.75;
  double seed_share = 0.2;

  void describe(FieldList& fields) {
    noise.describe(fields);
    fields.add("next_depth_std", next_depth_std, "1 sigma of a depth in the second image, relative", "",
               {0.001, 100.0});
    fields.add("false_alarm", false_alarm,
               "Probability that a static pixel is above the threshold, were the uncertainties exact", "",
               {1e-12, 0.5});
    fields.add("min_scale", min_scale,
               "Lower limit of the factor on the threshold, which falls where images agree better than the "
               "uncertainties say",
               "", {0.01, 1.0});
    fields.add(
        "hysteresis_ratio", hysteresis_ratio,
        "Pixels beyond this multiple of the threshold decide over their region (seed_share): wherever before "
        "the "
        "ground a static world might be where depth_backend radar_ground draws it, but within footprints of "
        "dynamic returns; 1: off",
        "", {1.0, 100.0});
    fields.add("seed_share", seed_share,
               "A region is kept only if this share of its pixels is beyond hysteresis_ratio", "",
               {0.0, 1.0});
  }
};

/// How a score becomes a mask.
struct MaskCleanupParams {
  int opening = 5;
  int closing = 9;
  int border = 0;

  void describe(FieldList& fields) {
    fields.add("opening", opening, "Width of the opening that removes isolated detections; 0: off", "px",
               {0, 999});
    fields.add("closing", closing, "Width of the closing that fills gaps; 0: off", "px", {0, 999});
    fields.add("border", border,
               "Reach, on both sides of the border of a region, within which the edges of the image decide "
               "what belongs to it, as flow blurs borders; 0: off",
               "px", {0, 999});
  }
};

/// How radar returns move a score.
struct RadarEvidenceParams {
  double dynamic_gain = 2.0;
  double radius = 1.0;
  double azimuth_std = 0.0;
  double static_gain = 0.0;

  void describe(FieldList& fields) {
    fields.add("radar_gain", dynamic_gain,
               "Within footprints of dynamic returns the score is multiplied by 1 + this; 0: off", "",
               {0.0, 100.0});
    fields.add("radar_radius", radius, "Radius of the footprint of a return", "m", {0.01, 100.0});
    fields.add("radar_azimuth_std", azimuth_std,
               "Lower limit of the half width of a footprint, as an angle seen from the camera", "rad",
               {0.0, 0.5});
    fields.add("static_gain", static_gain,
               "Within footprints of static returns only, the score is divided by 1 + this; 0: off", "",
               {0.0, 100.0});
  }
};

/// Parameters of MotionSegmenter. Why the defaults are what they are: docs/method.md.
struct MotionParams {
  MotionScore score = MotionScore::kPaper;
  PaperScoreParams paper;
  double max_depth = 120.0;
  double occlusion_margin = 0.5;
  bool predicted_in_view = true;
  UncertaintyScoreParams uncertainty;
  MaskCleanupParams cleanup;
  RadarEvidenceParams radar;

  void describe(FieldList& fields) {
    fields.group("Score");
    fields.add("score", score, "What turns the residual of a pixel into a score");
    paper.describe(fields);
    describeMaxDepth(max_depth, fields);
    fields.add(
        "occlusion_margin", occlusion_margin,
        "A predicted point is occluded if it lies farther than the depth seen there by this fraction of its "
        "own depth",
        "", {0.0, 1.0});
    fields.add("predicted_in_view", predicted_in_view, "Exclude pixels whose prediction leaves the image");
    fields.group("Uncertainty");
    uncertainty.describe(fields);
    fields.group("Mask");
    cleanup.describe(fields);
    fields.group("Radar");
    radar.describe(fields);
  }
};
/// @throws InvalidParameter, also for a flow without any noise
void validate(const MotionParams& params);

/// Two images, at t-1 and t, on one grid. Seen from the second image (motion_history.h) t is the earlier
/// time.
struct ImagePairInput {
  CameraIntrinsics camera;   ///< of the grid
  double pixel_scale = 1.0;  ///< px of the full image per px of the grid
  Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();  ///< staticPointMotion, m
  double duration = 0.0;                                                      ///< s, from t-1 to t
  cv::Mat flow;         ///< CV_32FC2, px of the grid, from t-1 to t; NaN = unknown
  cv::Mat flow_valid;   ///< CV_8UC1, 0 = unreliable; empty: all are reliable
  cv::Mat grey;         ///< CV_8UC1, the image at t-1; empty: borders stay where the flow has them
  cv::Mat second_grey;  ///< CV_8UC1, the image at t; empty: not compared with the first
  cv::Mat depth;        ///< CV_32FC1, m, at t-1 (the paper's D_{t-1}); NaN, 0 or less = unknown
  cv::Mat next_depth;   ///< CV_32FC1, m, at t (the paper's D_t); empty: no depth residual anywhere
  /// Where depth is drawn by little knowledge: what is static may as well lie anywhere before this plane.
  /// None: depth is measured.
  std::optional<GroundPlane> ground;
};

/// How well a pair is known, for the score by uncertainty and the refinement.
struct PairUncertainty {
  /// CV_32FC1, px of the grid: the forward-backward error; empty or NaN: not known
  cv::Mat fb_error;
  /// CV_32FC1, px of the grid: 1 sigma of the flow besides, by lack of texture; empty: nothing is added
  cv::Mat texture_std;
  /// CV_32FC1, 1 sigma of the inverse depth at t-1, relative; empty, NaN or negative: MotionParams
  cv::Mat depth_std;
  /// Of a small motion (omega, tau) after T_current_from_previous, X -> X + omega x X + tau: rad^2, rad m,
  /// m^2, camera frame at t
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// What speaks for or against a motion besides the pair.
struct MotionEvidence {
  /// Radar returns, camera frame at t-1. Where the residual of a dynamic one is known, it does not count
  /// where the flow is that of the static world rather than that of a thing so far and so fast along the line
  /// of sight.
  std::vector<CloudPoint> dynamic_points, static_points;
  /// CV_32FC1, log-odds that a pixel moves, from the images before (carriedBelief); NaN: nothing is known;
  /// empty: nowhere. For the score by uncertainty.
  cv::Mat belief;
};

/// All that a score is made of.
struct MotionInput : ImagePairInput, PairUncertainty, MotionEvidence {};

/// Outcome of one pair, on the grid of the input.
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

  /// @param before  the first image together with the previous one, seen from the first image
  ///                (seenFromSecond), with the same camera, depth and returns; or null. A pixel that the
  ///                second image does not show any more, or whose flow is wrong, may be seen well there. Its
  ///                score is the root mean square of the two, each over its own scale; or the one that there
  ///                is. The threshold stays that of one: their errors are partly the same. Score by
  ///                uncertainty only.
  /// @throws std::invalid_argument for images of other types or sizes than the camera's grid, and `before` or
  ///         a belief with the paper's score.
  MotionResult segment(const MotionInput& input, const MotionInput* before = nullptr);
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
