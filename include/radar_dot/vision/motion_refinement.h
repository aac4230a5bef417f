// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// How well the motion of the base frame is known without looking at images, 1 sigma. Radar measures it in
/// the plane of the ground; nothing measures how the body pitches and rolls, by ramps and brakes.
struct MotionUncertainty {
  double forward_velocity_std = 0.1;    ///< m/s
  double lateral_velocity_std = 0.06;   ///< m/s
  double vertical_velocity_std = 0.06;  ///< m/s
  double yaw_rate_std = 0.006;          ///< rad/s
  double tilt_std = 0.014;  ///< rad after one second, of pitch and roll each, growing with its root
};
/// Covariance of (omega, tau) in the base frame after `dt` s, rad^2 and m^2.
/// @throws std::invalid_argument for deviations below zero
Eigen::Matrix<double, 6, 6> baseMotionCovariance(const MotionUncertainty& uncertainty, double dt);

/// Parameters of refineMotion. 1 sigma each; px of the camera's full image.
struct RefinementParams {
  double flow_std = 2.0;            ///< px, of each component of a flow
  double flow_std_relative = 0.03;  ///< share of the flow's length, on top
  double fb_error_weight = 0.3;      ///< weight of the forward-backward error, where available
  double depth_std = 0.3;           ///< share of the inverse depth, where MotionInput::depth_std does not say
  /// The same of the ground plane, whatever MotionInput::depth_std says: what it says of pitch and height is
  /// in the two below, which are estimated.
  double ground_depth_std = GroundUncertainty{}.relative_std;
  double ground_pitch_std = GroundUncertainty{}.pitch_std;    ///< rad, of the ground before the vehicle
  double ground_height_std = GroundUncertainty{}.height_std;  ///< m
  /// The errors of neighbours are alike: all pixels together tell as much as this many independent ones.
  double independent_pixels = 300.0;
  /// Squared distance, in units of its expectation, from which on a pixel hardly counts: Geman and McClure's
  /// weights, 1 / (1 + distance / this)^2.
  double kernel_width = 2.0;
  int stride = 16;     ///< px, between the pixels that are looked at
  int iterations = 8;  ///< of reweighted least squares
};
/// @throws std::invalid_argument naming the invalid parameter.
void validate(const RefinementParams& params);

/// The ground plane that a part of MotionInput::depth shows (groundDepth).
struct GroundPlane {
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();  ///< at t-1
  double height = 0.0;                                                   ///< m, base frame
  double pitch = 0.0;                                                    ///< rad, nose down positive
};

/// What refineMotion found.
struct RefinedMotion {
  Eigen::Isometry3d T_current_from_previous = Eigen::Isometry3d::Identity();
  /// (omega, tau) after the motion given, rad and m, camera frame at t
  Eigen::Matrix<double, 6, 1> correction = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< of the refined motion
  std::optional<GroundPlane> ground;     ///< refined, where one was given
  GroundUncertainty ground_uncertainty;  ///< of the refined ground
  std::size_t pixels = 0;                ///< that were looked at; fewer than 50: the motion is the one given
};

/// Motion of the camera from flow and depth of all pixels, with the motion given and its covariance as the
/// prior: what radar measures well stays, what it does not (pitch, roll) comes from the image.
///
/// Minimises, over a small motion (omega, tau) after the given one and, where the ground is given, its pitch
/// and height,
///     sum_i rho(r_i^T Sigma_i^-1 r_i) + (omega, tau)^T Sigma_motion^-1 (omega, tau) + priors of the ground
/// by Gauss-Newton with Geman and McClure's weights; r_i and Sigma_i (of flow and inverse depth) as in
/// uncertainty_terms.h. A direction whose variance in motion_covariance is zero does not change.
/// @param ground  the plane that was drawn into the depth; pixels whose depth differs from it by more than
///                1 % are not ground
/// @throws std::invalid_argument for images of other types or sizes than the camera's grid.
RefinedMotion refineMotion(const MotionInput& input, const std::optional<GroundPlane>& ground = std::nullopt,
                           const RefinementParams& params = {});

/// Depth whose pixels of one ground plane are those of another. @param max_depth  m, farther is unknown
cv::Mat replaceGroundDepth(const cv::Mat& depth, const CameraIntrinsics& camera, const GroundPlane& drawn,
                       const GroundPlane& refined, double max_depth);

/// The uncertainty of that depth (share of the inverse depth, CV_32FC1): where `depth` shows the drawn
/// ground, that of the refined one, else as in `relative_std`. @param depth  m, before its ground is
/// exchanged
cv::Mat replaceGroundStd(const cv::Mat& relative_std, const cv::Mat& depth, const CameraIntrinsics& camera,
                          const GroundPlane& drawn, const RefinedMotion& refined);

/// A pair with its motion refined (refineMotion): motion, covariance, and where the ground is given, both
/// depths and their uncertainty. @param max_depth  m, ground farther than this is unknown
void refineInput(MotionInput& input, const std::optional<GroundPlane>& ground, double max_depth,
                 const RefinementParams& params = {});

}  // namespace radar_dot
