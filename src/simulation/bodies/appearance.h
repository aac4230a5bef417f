// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "radar_dot/simulation/mesh.h"
#include "simulation/bodies/noise.h"

namespace radar_dot::simulation {

/// How a point of a surface reflects light.
struct Appearance {
  Color albedo = Color::Constant(0.5F);  ///< diffuse reflectance
  Color emission = Color::Zero();        ///< radiance, times the lighting's night level
  float mirror = 0.0F;                   ///< reflectance at normal incidence of a smooth coat; 0 = matt
  float highlight = 0.0F;                ///< strength of the sun's blurred reflection
  float highlight_exponent = 30.0F;
  float translucency = 0.0F;  ///< fraction of the light from behind that comes through
  float bump = 0.0F;          ///< slope of the surface's waves, for reflections
};

/// Where on a surface.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m, in the frame the pattern is fixed to
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();   ///< same frame
  PixelFootprint footprint;
  std::uint32_t object_seed = 0;  ///< of the whole object: no two houses alike
  std::uint32_t patch_seed = 0;   ///< of a pane, a leaf
  bool night = false;
};

/// The look of a material: pattern, colour and gloss, without what a pixel cannot resolve.
Appearance appearanceOf(Material material, const Color& color, const SurfacePoint& point);

/// Does the pattern lie in the map (ground) rather than in the object's frame.
bool isGround(Material material) noexcept;

}  // namespace radar_dot::simulation
