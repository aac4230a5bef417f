// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/motion_terms.h"

/// How far the flow of a static point may be from its prediction, for one pixel, in single precision.
///
/// The residual r = f_obs - f_est (2 x 1) of a static point is not zero, because four things are known with
/// an error only: the flow, the inverse depth rho = 1 / D, the motion of the camera, and the depth seen in
/// the second image. To first order its covariance is
///
///     Sigma = sigma_flow^2 I  +  g g^T sigma_rho^2  +  J Sigma_motion J^T
///
/// with g = d(u', v') / d rho and J = d(u', v') / d(omega, tau). The error of depth moves the prediction
/// along g only, the direction to the focus of expansion; across it even a small residual indicates motion. A
/// single tolerance for both, as the paper's, must be as wide as the wider one. The score is the Mahalanobis
/// distance
///
///     s^2 = r^T Sigma^-1 r  +  (D_t(u', v') - Z_est)^2 / sigma_Z^2
///
/// whose square is distributed as chi-square with 2 degrees of freedom, or 3 where depth is seen in the
/// second image, of a static point.
namespace radar_dot::uncertainty_terms {

/// Derivative of (u', v') by rho = 1 / D, px m. Of X_t = D (R x + rho t) only the direction counts, so that
/// (u', v', 1) ~ H p + rho h: with w = (H p + rho h)_3 = Z_est / D,
///     du' / drho = (h_1 - u' h_3) / w,    dv' / drho = (h_2 - v' h_3) / w.
struct PixelShift {
  float u = 0.0F, v = 0.0F;
};
inline PixelShift byInverseDepth(const motion_terms::PixelMotion& motion, float depth,
                                 const motion_terms::Prediction& predicted) {
  const float over_w = depth / predicted.depth;
  return {(motion.h[0] - predicted.u * motion.h[2]) * over_w,
          (motion.h[1] - predicted.v * motion.h[2]) * over_w};
}

/// X -> X + omega x X + tau, in the camera frame at t; rad and m.
struct SmallMotion {
  float omega_x = 0.0F, omega_y = 0.0F, omega_z = 0.0F, tau_x = 0.0F, tau_y = 0.0F, tau_z = 0.0F;
};

/// By how much a small motion after the given one shifts (u', v'), px, to first order: J (omega, tau). With
/// x = (u' - cx) / fx, y = (v' - cy) / fy and q = 1 / Z_est, J is
///     fx (-x y, 1 + x^2, -y, q, 0, -x q),    fy (-1 - y^2, x y, x, 0, q, -y q).
inline PixelShift byMotion(float fx, float fy, float x, float y, float q, const SmallMotion& motion) {
  const float radial = x * motion.omega_y - y * motion.omega_x - q * motion.tau_z;
  return {fx * (x * radial + motion.omega_y - y * motion.omega_z + q * motion.tau_x),
          fy * (y * radial - motion.omega_x + x * motion.omega_z + q * motion.tau_y)};
}

/// A covariance of (u', v'), px^2.
struct Covariance {
  float uu = 0.0F, uv = 0.0F, vv = 0.0F;
};

/// Small motions L whose squares make the covariance of (omega, tau), Sigma = sum L L^T, so that J Sigma J^T
/// is the sum of the squares of the shifts by each. As many as Sigma has directions that are not exact.
/// @throws std::invalid_argument for a matrix that is no covariance
std::vector<SmallMotion> spreadOf(const Eigen::Matrix<double, 6, 6>& covariance);

/// r^T Sigma^-1 r.
inline float squaredDistance(float r_u, float r_v, const Covariance& covariance) {
  const float determinant = covariance.uu * covariance.vv - covariance.uv * covariance.uv;
  return (covariance.vv * r_u * r_u - 2.0F * covariance.uv * r_u * r_v + covariance.uu * r_v * r_v) /
         determinant;
}

/// The s that a static point exceeds with this probability: root of the quantile of the chi-square
/// distribution. @param degrees  2 or 3  @param false_alarm  between 0 and 1
double chiThreshold(int degrees, double false_alarm);

/// Median of s over static points whose model is right: 1.177 or 1.538. @param degrees  2 or 3
double chiMedian(int degrees);

}  // namespace radar_dot::uncertainty_terms
