// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation.h"

#include <algorithm>
#include <cmath>

namespace radar_dot {

void segmentReturns(const SegmentationParams& params, const std::vector<float>& residuals,
                    const std::vector<Eigen::Vector2f>& positions, std::vector<std::size_t>& candidates,
                    std::vector<ReturnLabel>& labels) {
  labels.assign(residuals.size(), ReturnLabel::kStatic);
  if (!params.neighbourhood) {
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (std::abs(residuals[i]) >= static_cast<float>(params.threshold)) labels[i] = ReturnLabel::kDynamic;
    }
    return;
  }

  const auto isolated = static_cast<float>(params.isolated_threshold);
  const auto supported = static_cast<float>(params.supported_threshold);
  const auto distance = static_cast<float>(params.neighbour_distance);
  const auto velocity = static_cast<float>(params.neighbour_velocity);
  candidates.clear();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (std::abs(residuals[i]) >= isolated) labels[i] = ReturnLabel::kDynamic;
    if (std::abs(residuals[i]) >= std::min(supported, isolated)) candidates.push_back(i);
  }
  // Sorted by x, the neighbours of a return stand next to it in the list, before and after.
  std::sort(candidates.begin(), candidates.end(),
            [&](std::size_t a, std::size_t b) { return positions[a].x() < positions[b].x(); });
  const auto moveTogether = [&](std::size_t i, std::size_t j) {
    return (positions[j] - positions[i]).squaredNorm() <= distance * distance &&
           std::abs(residuals[i] - residuals[j]) <= velocity;
  };
  const auto hasSupport = [&](std::size_t entry) {
    const std::size_t i = candidates[entry];
    for (std::size_t k = entry; k-- > 0 && positions[i].x() - positions[candidates[k]].x() <= distance;) {
      if (moveTogether(i, candidates[k])) return true;
    }
    for (std::size_t k = entry + 1;
         k < candidates.size() && positions[candidates[k]].x() - positions[i].x() <= distance; ++k) {
      if (moveTogether(i, candidates[k])) return true;
    }
    return false;
  };
  for (std::size_t entry = 0; entry < candidates.size(); ++entry) {
    ReturnLabel& label = labels[candidates[entry]];
    if (label == ReturnLabel::kStatic && hasSupport(entry)) label = ReturnLabel::kDynamic;
  }
}

}  // namespace radar_dot
