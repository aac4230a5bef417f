// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// Static/dynamic labels from signed residuals (m/s) and positions (m, base frame, brought to one
/// time). Without `neighbourhood` this is the paper's e_i < tau.
/// @param candidates  scratch memory, kept by the caller
void segmentReturns(const SegmentationParams& params, const std::vector<float>& residuals,
                    const std::vector<Eigen::Vector2f>& positions, std::vector<std::size_t>& candidates,
                    std::vector<ReturnLabel>& labels);

}  // namespace radar_dot
