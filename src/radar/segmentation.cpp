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
    if (std::abs(residuals[i]) >= supported) candidates.push_back(i);
  }
  // Sorted by x, a neighbour lies within a short stretch of the list.
  std::sort(candidates.begin(), candidates.end(),
            [&](std::size_t a, std::size_t b) { return positions[a].x() < positions[b].x(); });
  for (std::size_t first = 0; first < candidates.size(); ++first) {
    const std::size_t i = candidates[first];
    if (std::abs(residuals[i]) >= isolated) labels[i] = ReturnLabel::kDynamic;
    for (std::size_t second = first + 1; second < candidates.size(); ++second) {
      const std::size_t j = candidates[second];
      if (positions[j].x() - positions[i].x() > distance) break;
      if ((positions[j] - positions[i]).squaredNorm() <= distance * distance &&
          std::abs(residuals[i] - residuals[j]) <= velocity) {
        labels[i] = labels[j] = ReturnLabel::kDynamic;
      }
    }
  }
}

}  // namespace radar_dot
