// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/uncertainty_terms.h"

namespace radar_dot {

// What lies in a pixel of the image of radar footprints: this, or that of the first dynamic return plus the
// index of one.
constexpr std::uint16_t kNoReturn = 0;
constexpr std::uint16_t kStaticReturn = 1;
constexpr std::uint16_t kDynamicReturn = 2;

/// What a dynamic return is of.
struct Mover {
  motion_terms::PixelMotion motion;       // of its points, where it moves along the line of sight only
  uncertainty_terms::SmallMotion across;  // 1 sigma of its motion besides
  float depth, inverse_depth_std;         // m, 1/m
  bool has_speed;
};

inline bool isKnownDepth(float depth, float max_depth) {
  constexpr float kNearest = 1e-3F;  // m; of what is nearer, as of a denormal number, 1 / depth overflows
  return depth >= kNearest && depth <= max_depth;
}

/// What the pass over the image needs, in single precision.
struct PassConstants {
  PassConstants(const MotionInput& input, const MotionParams& params, double median);

  motion_terms::PixelMotion motion;
  float pixel_scale, lambda, min_depth, max_depth, occlusion_margin, median_depth;
  float flow_std, flow_std_relative, fb_error_weight, depth_std,
      next_depth_std;    // px of the grid, shares
  float fx, fy, cx, cy;  // px of the grid
  std::vector<uncertainty_terms::SmallMotion> spread;
  bool by_uncertainty;
  float static_factor, dynamic_factor;  // of scores within footprints
  std::vector<Mover> movers;
  float last_u, last_v;
  bool predicted_in_view;
  std::vector<float> foe_columns,
      foe_rows;  // factors of the weight of the focus of expansion
};

/// Pointers to the pixels of one row of the inputs; null: that image is not there.
struct InputRow {
  const float* depths = nullptr;
  const float* flows = nullptr;  // pairs
  const std::uint8_t* reliable = nullptr;
  const float* closures = nullptr;
  const float* textures = nullptr;
  const float* depth_stds = nullptr;
  const std::uint16_t* footprint = nullptr;
};

/// The scores of one row; NaN where a pixel is excluded.
void scoreRow(const PassConstants& pass, const motion_terms::FloatImage& next_depth, int row,
              const InputRow& input, int columns, float* scores);

/// px^2 of the flow of a pixel, besides that of all flow.
float flowNoise(const PassConstants& pass, const InputRow& input, int column);

/// Standard deviations of the flow of a pixel from that of the most likely static point of its ray.
/// @param farthest  1/m, where the ray meets the ground; not positive: nowhere
/// @param noise     px^2, besides that of all flow
float distanceFromStatic(const PassConstants& pass, float u, float v, float farthest, const float* flow,
                         float noise);

}  // namespace radar_dot
