// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "radar_dot/vision/camera_intrinsics.h"

/// The terms of the paper's section "Dynamic Object Segmentation", one function each, for one pixel, in
/// single precision. MotionSegmenter uses these very functions. Lengths in px are px of the full image.
namespace radar_dot::motion_terms {

/// Where a static point is predicted to be: (u', v') in px of the grid, and Z_est in m.
struct Prediction {
  float u = 0.0F, v = 0.0F, depth = 0.0F;
};

/// The two equations X_t = R X_{t-1} + t and (u', v', 1) ~ K X_t, with X_{t-1} = D K^-1 (u, v, 1), multiplied
/// out for a fixed camera and motion: K X_t = D (H p) + h with H = K R K^-1 and h = K t.
struct PixelMotion {
  PixelMotion(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous);
  float H[3][3];
  float h[3];
};

/// K X_t over its third component; the depth may be zero or negative where the point is behind the camera.
inline Prediction predict(const PixelMotion& motion, float u, float v, float depth) {
  const float x = depth * (motion.H[0][0] * u + (motion.H[0][1] * v + motion.H[0][2])) + motion.h[0];
  const float y = depth * (motion.H[1][0] * u + (motion.H[1][1] * v + motion.H[1][2])) + motion.h[1];
  const float z = depth * (motion.H[2][0] * u + (motion.H[2][1] * v + motion.H[2][2])) + motion.h[2];
  const float inverse = 1.0F / z;
  return {x * inverse, y * inverse, z};
}

/// e_flow = || f_obs - f_est ||, with both flows in px of the grid, times px of the full image per px of the
/// grid.
inline float flowResidual(float observed_x, float observed_y, float expected_x, float expected_y,
                          float pixel_scale) {
  const float x = observed_x - expected_x;
  const float y = observed_y - expected_y;
  return pixel_scale * std::sqrt(x * x + y * y);
}

/// e_depth = | D_t(u', v') - Z_est |, m; zero where D_t is not known there (NaN).
inline float depthResidual(float depth_seen, float depth_predicted) {
  const float residual = std::fabs(depth_seen - depth_predicted);
  return residual >= 0.0F ? residual : 0.0F;
}

/// Is the point predicted at Z_est hidden behind what is seen there? False where nothing is known.
inline bool isOccluded(float depth_seen, float depth_predicted, float margin) {
  return depth_seen < (1.0F - margin) * depth_predicted;
}

/// max(D_{t-1}, Z_min): the paper's sigma_depth, m.
inline float depthTolerance(float depth, float min_depth) { return std::max(depth, min_depth); }

/// One coordinate's factor of exp(-d_FOE^2 / (2 sigma_FOE^2)): the weight of a pixel is the product of the
/// factors of its column and its row, so that a row of pixels needs no exponentials.
inline float foeFactor(float distance, float inverse_two_variance) {
  return std::exp(-(distance * distance) * inverse_two_variance);
}

/// The paper's sigma_flow: (1 + Z~ / max(D, Z_min)) (1 + weight of the focus of expansion).
inline float flowTolerance(float median_depth, float depth, float min_depth, float foe_weight) {
  return (1.0F + median_depth / std::max(depth, min_depth)) * (1.0F + foe_weight);
}

/// S = e_flow / sigma_flow + lambda e_depth / sigma_depth.
inline float motionScore(float flow_residual, float flow_tolerance, float depth_residual,
                         float depth_tolerance, float lambda) {
  return flow_residual / flow_tolerance + lambda * (depth_residual / depth_tolerance);
}

/// tau = median(S) + k MAD(S), but at least `minimum`.
inline float robustThreshold(float median, float mad, float k, float minimum) {
  return std::max(median + k * mad, minimum);
}

/// Focus of expansion, px of the grid: K t / t_z, the pixel towards (or away from) which the camera moves.
/// None where it lies at infinity: the camera stands, or moves across its optical axis.
std::optional<Eigen::Vector2d> focusOfExpansion(const CameraIntrinsics& camera,
                                                const Eigen::Vector3d& translation);

/// The pixels of a CV_32FC1 image, which must outlive it; null for an empty image.
struct FloatImage {
  explicit FloatImage(const cv::Mat& image)
      : pixels(image.empty() ? nullptr : image.ptr<float>()),
        stride(image.empty() ? 0 : static_cast<std::ptrdiff_t>(image.step1())),
        columns(image.cols),
        rows(image.rows) {}
  const float* pixels;
  std::ptrdiff_t stride;  ///< pixels from one row to the next
  int columns, rows;
};

/// Value of an image of 2 x 2 pixels or more between four of its pixels; NaN where one of them is NaN, or
/// outside.
inline float bilinear(const FloatImage& image, float u, float v) {
  if (!(u >= 0.0F && v >= 0.0F && u <= static_cast<float>(image.columns - 1) &&
        v <= static_cast<float>(image.rows - 1))) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const int x = std::min(static_cast<int>(u), image.columns - 2);
  const int y = std::min(static_cast<int>(v), image.rows - 2);
  const float a = u - static_cast<float>(x);
  const float b = v - static_cast<float>(y);
  const float* above = image.pixels + y * image.stride + x;
  const float* below = above + image.stride;
  const float top = above[0] + a * (above[1] - above[0]);
  const float bottom = below[0] + a * (below[1] - below[0]);
  return top + b * (bottom - top);
}

}  // namespace radar_dot::motion_terms
