// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace radar_dot {

/// How far a radar return stands for what is beside it, m: `reach` where it is alone. Where returns are
/// dense, as those of imaging radars, each stands for less, so that a car that gives fifty is not widened by
/// any of them.
/// @param places  m, on the ground; such that are not finite have the whole reach
std::vector<float> reachesOf(const std::vector<Eigen::Vector2f>& places, float reach);

}  // namespace radar_dot
