// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/simulation/mesh.h"
#include "radar_dot/simulation/model.h"

namespace radar_dot::simulation {

struct WheelShape {
  float radius = 0.32F;      ///< m, of the tyre
  float width = 0.2F;        ///< m
  float rim_radius = 0.22F;  ///< m
  int spokes = 5;
  float rim_grey = 0.5F;
};

/// Adds a wheel with its axle along y at (x, y, radius): its outside looks away from the middle.
void addWheel(Model& model, const WheelShape& shape, double x, double y, bool steered);

/// European number plate in the y-z plane; `front` looks ahead.
void addNumberPlate(MeshBuilder& builder, const Eigen::Vector3f& centre, bool front);

/// A pair of outside mirrors; `root` is the left one's foot on the body.
void addMirrors(MeshBuilder& builder, const Eigen::Vector3f& root, const Eigen::Vector3f& size);

}  // namespace radar_dot::simulation
