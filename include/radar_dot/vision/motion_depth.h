// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/motion_refinement.h"

namespace radar_dot {

/// Parameters of MotionDepth. px of the grid.
struct MotionDepthParams {
  double max_interval = 0.25;
  double min_baseline = 0.02;
  double flow_std = 0.3;
  double flow_std_relative = 0.03;
  double fb_error_weight = 0.3;
  double max_fb_error = 1.5;
  double max_fb_error_relative = 0.1;
  double growth = 0.08;
  double max_deviation = 3.0;
  bool refine = true;
  RefinementParams refinement = quickRefinement();

  void describe(FieldList& fields);

 private:
  /// Consecutive images leave little to correct.
  static RefinementParams quickRefinement() {
    RefinementParams params;
    params.stride = 32;
    params.iterations = 4;
    return params;
  }
};

/// Where the depth of a pixel comes from.
enum class DepthOrigin : std::uint8_t {
  kPrior,   ///< the prior: nothing was measured since the pixel is followed
  kMotion,  ///< measured, in this image or an earlier one
  kRefused  ///< measured before, but what is seen now is no static point: not to be used, see the prior
};

/// A new image, and how it follows from the previous one. All images lie on the grid of `camera`.
struct MotionDepthInput {
  CameraIntrinsics camera;
  double pixel_scale = 1.0;  ///< px of the full image per px of the grid
  double time = 0.0;         ///< s, of the image
  cv::Mat prior_depth;       ///< CV_32FC1, m, what is known without images before; NaN: unknown
  cv::Mat prior_std;         ///< CV_32FC1, 1 sigma of its inverse, relative (DepthEstimator::relativeStd)

  /// CV_32FC1, m, which no static point is beyond: the ground, as far as its uncertainty lets it be; infinity
  /// or NaN: no limit; empty: nowhere
  cv::Mat farthest = {};

  /// What leads back to the previous image.
  struct Step {
    double previous_time = 0.0;  ///< s
    /// staticPointMotion: takes a static point from the previous camera frame to that of this image, m
    Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();
    /// Of a small motion (omega, tau) after it, as PairUncertainty::motion_covariance
    Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();
    cv::Mat flow_back;  ///< CV_32FC2, px of the grid, from this image to the previous one; NaN = unknown
    cv::Mat fb_error;   ///< CV_32FC1, px, its forward-backward error; NaN = leaves the image
  };
  std::optional<Step> step;  ///< none: a first image
};

/// Depth of an image, on its grid.
struct MotionDepthResult {
  cv::Mat depth;          ///< CV_32FC1, m; NaN where neither prior nor motion tells it
  cv::Mat relative_std;   ///< CV_32FC1, 1 sigma of the inverse depth, relative; NaN where depth is
  cv::Mat origin;         ///< CV_8UC1, DepthOrigin
  bool followed = false;  ///< the previous image took part; else all is the prior
  bool measured = false;  ///< and the camera has moved since, so that depth was measured
  Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();  ///< refined where `measured`
};

/// Depth of a static world from the motion of the camera: a filter of the inverse depth rho of every pixel,
/// which the flow carries from image to image and the parallax of each pair updates.
///
/// With T = (R, t) from the previous camera frame to the current one, p' = p + flow_back(p) and w =
/// (R K^-1 p' + rho t)_z the depth grows by the factor w:
///     rho- = rho(p') / w,    P- = P(p') (R K^-1 p')_z^2 / w^4 + (growth rho-)^2.
/// Backwards, p' ~ H p + rho h with H = K R^T K^-1 and h = -K R^T t. With a = (H p)_12 - p' (H p)_3 and b =
/// h_12 - p' h_3 the point on the epipolar line nearest to p' has
///     rho_m = -a.b / b.b,    sigma_m^2 = s^2 w'^2 / b.b,    w' = (H p + rho- h)_3
/// with s, px, of flow, its forward-backward error and the motion. What is farther than max_deviation s from
/// the epipolar line, or behind the camera, moves independently or has no flow: it is not measured.
/// An innovation farther than max_deviation sigma first widens P-: a wrong start does not persist.
///
/// Pixels start with the prior: where flow and its way back do not close, at what comes into view, and all of
/// them where the previous image is not the one seen last, is older than max_interval, or has another
/// grid. While the camera stands the depths are carried, and nothing is measured.
///
/// On what moves along with the epipolar line, a car ahead above all, the depth is wrong, and sure of itself:
/// a pixel that may move takes the prior.
class MotionDepth {
 public:
  /// @throws InvalidParameter
  explicit MotionDepth(const MotionDepthParams& params = {});

  /// Images come in the order of time.
  /// @throws std::invalid_argument for images of other types or sizes than the camera's grid
  MotionDepthResult update(const MotionDepthInput& input);
  /// The next image is a first one.
  void clear();
  const MotionDepthParams& params() const noexcept { return params_; }

 private:
  /// Of one image: inverse depth (1/m; NaN: unknown), its variance, origin.
  struct State {
    double time = 0.0;
    cv::Mat rho, variance, origin;
  };
  bool follows(const MotionDepthInput& input) const;
  State predicted(const MotionDepthInput& input, bool moved);
  void refine(const MotionDepthInput& input, const MotionDepthResult& predicted,
              MotionDepthInput::Step& step) const;
  void measure(const MotionDepthInput& input, const MotionDepthInput::Step& step, State& state) const;
  static void show(const State& state, const cv::Mat& prior, int stride, MotionDepthResult& result);

  MotionDepthParams params_;
  std::optional<State> state_;
  State spare_;  // its memory
};

}  // namespace radar_dot
