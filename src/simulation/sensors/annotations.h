// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "radar_dot/dataset/new_scene.h"
#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/trajectory.h"
#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// How much of every actor the six cameras of the vehicle see: fraction of points sampled on its surface
/// that are in view of one of them with nothing else in between, 0..1; 0 beyond 100 m.
/// @return one number per actor
std::vector<double> visibleShares(const World& world, const Snapshot& snapshot, const Trajectory& ego);

/// What a keyframe's sensors found of each actor.
struct Findings {
  explicit Findings(std::size_t actors = 0) : lidar(actors, 0), radar(actors, 0), masks(actors, 0) {}
  std::vector<int> lidar, radar;  ///< returns
  std::vector<int> masks;         ///< images with a mask of it
};

/// Annotations of the actors in a keyframe: those within 100 m that lidar or radar saw, as in nuScenes,
/// and those with a mask in an image.
/// `instance` of each is the number of the actor.
std::vector<dataset::NewAnnotation> annotate(const World& world, const Trajectory& ego, double time_s,
                                             std::size_t sample, const Findings& found,
                                             const std::vector<double>& visible_shares);

/// nuScenes' level of a visible share: 1 to 4.
int visibilityLevel(double visible_share);

}  // namespace radar_dot::simulation
