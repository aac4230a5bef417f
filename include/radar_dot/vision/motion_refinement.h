// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "radar_dot/vision/ground_plane.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// How well the motion of the base frame is known without looking at images, 1 sigma. Radar measures it in
/// the plane of the ground; nothing measures how the body pitches and rolls, by ramps and brakes.
struct MotionUncertainty {
  double forward_velocity_std = 0.1;
  double lateral_velocity_std = 0.06;
  double vertical_velocity_std = 0.06;
  double yaw_rate_std = 0.006;
  double tilt_std = 0.014;  // grows with the root of the time

  void describe(FieldList& fields) {
    fields.add("forward_velocity_std", forward_velocity_std, "1 sigma of the forward velocity", "m/s",
               {0.0, 100.0});
    fields.add("lateral_velocity_std", lateral_velocity_std, "1 sigma of the lateral velocity", "m/s",
               {0.0, 100.0});
    fields.add("vertical_velocity_std", vertical_velocity_std, "1 sigma of the vertical velocity", "m/s",
               {0.0, 100.0});
    fields.add("yaw_rate_std", yaw_rate_std, "1 sigma of the yaw rate", "rad/s", {0.0, 10.0});
    fields.add("tilt_std", tilt_std, "1 sigma of pitch and of roll after one second", "rad", {0.0, 1.0});
  }
};
/// Covariance of (omega, tau) in the base frame after `dt` s, rad^2 and m^2.
/// @throws InvalidParameter for deviations below zero
Eigen::Matrix<double, 6, 6> baseMotionCovariance(const MotionUncertainty& uncertainty, double dt);
/// As configured, or where a twist is less certain of its velocities or its yaw rate, as uncertain as it
/// says. What it does not observe stays as it is.
/// @param twist         StampedTwist::covariance
/// @param has_rotation  the yaw is known from a source of rotation instead of the twist
MotionUncertainty motionUncertainty(const MotionUncertainty& configured,
                                    const Eigen::Matrix<double, 6, 6>& twist, bool has_rotation);

/// Parameters of refineMotion.
struct RefinementParams {
  double independent_pixels = 300.0;  // the errors of neighbours are alike
  double kernel_width = 2.0;          // Geman and McClure's weights: 1 / (1 + distance / this)^2
  int stride = 16;
  int iterations = 8;

  void describe(FieldList& fields) {
    fields.add("refine_independent_pixels", independent_pixels,
               "All pixels together carry the information of this many independent ones", "", {1.0, 1e7});
    fields.add("refine_kernel_width", kernel_width,
               "Squared residual, in units of its expectation, from which on a pixel is down-weighted", "",
               {0.01, 1000.0});
    fields.add("refine_stride", stride, "Distance between the pixels that are used", "px", {1, 1000});
    fields.add("refine_iterations", iterations, "Iterations of reweighted least squares", "", {1, 100});
  }
};

/// Of the pixels of a grid that are used, from the half of it on. @param pixel_scale  px of the full image
/// per px of the grid
int strideOf(const RefinementParams& params, double pixel_scale);

/// What refineMotion found.
struct RefinedMotion {
  Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();
  /// (omega, tau) after the motion given, rad and m, camera frame at t
  Eigen::Matrix<double, 6, 1> correction = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the refined motion
  double rotation_weight = 1.0;       ///< of the prior of the rotation: less where the image contradicts it
  std::optional<GroundPlane> ground;  ///< refined, with its uncertainty, where one was given
  std::size_t pixels = 0;             ///< that were looked at; fewer than 50: the motion is the one given
};

/// Motion of the camera from flow and depth of all pixels, with the motion given and its covariance as the
/// prior: what radar measures well stays, what it does not (pitch, roll) comes from the image.
///
/// Minimises, over a small motion (omega, tau) after the given one and, where the ground is given, its pitch
/// and height,
///     sum_i rho(r_i^T Sigma_i^-1 r_i) + rho(omega^T Sigma_omega^-1 omega)
///         + (tau given omega)^T Sigma_tau|omega^-1 (tau given omega) + priors of the ground
/// by Gauss-Newton with Geman and McClure's weights; r_i and Sigma_i (of flow and inverse depth) as in
/// uncertainty_terms.h. A direction whose variance in motion_covariance is zero does not change.
/// The prior of the rotation has such a weight (rho) as well, so that one that is wrong or late gives way;
/// where its variance is zero in any direction, it holds. A rotation beyond five of its sigmas and what a
/// vehicle can turn on its way (a radius of 4 m), which the given one was not, is not its own: something
/// fills the image, and the motion is the one given.
/// @param ground  the plane that was drawn into the depth; pixels whose depth differs from it by more than
///                1 % are not ground
/// @throws std::invalid_argument for images of other types or sizes than the camera's grid; InvalidParameter.
RefinedMotion refineMotion(const MotionInput& input, const std::optional<GroundPlane>& ground = std::nullopt,
                           const FlowDepthNoise& noise = {}, const RefinementParams& params = {});

/// Depth whose pixels of one ground plane are those of another. @param max_depth  m, farther is unknown
cv::Mat replaceGroundDepth(const cv::Mat& depth, const CameraIntrinsics& camera, const GroundPlane& drawn,
                           const GroundPlane& refined, double max_depth);

/// The uncertainty of that depth (fraction of the inverse depth, CV_32FC1): where `depth` shows the drawn
/// ground, that of the refined one, else as in `relative_std`. @param depth  m, before its ground is
/// exchanged
cv::Mat replaceGroundStd(const cv::Mat& relative_std, const cv::Mat& depth, const CameraIntrinsics& camera,
                         const GroundPlane& drawn, const RefinedMotion& refined);

/// A pair with its motion refined (refineMotion): motion, covariance, and where the ground is given, both
/// depths and their uncertainty; the ground turns with the motion from t-1 to t.
/// @param max_depth  m, ground farther than this is unknown
/// @return RefinedMotion::rotation_weight
double refineInput(MotionInput& input, const std::optional<GroundPlane>& ground, double max_depth,
                   const FlowDepthNoise& noise = {}, const RefinementParams& params = {});

}  // namespace radar_dot
