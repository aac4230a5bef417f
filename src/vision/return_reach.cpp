// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/return_reach.h"

#include <algorithm>
#include <cstddef>

namespace radar_dot {
namespace {

constexpr float kSparse = 3.0F;  // returns within the reach, itself included, that all have it whole

}  // namespace

std::vector<float> reachesOf(const std::vector<Eigen::Vector2f>& places, float reach) {
  std::vector<float> reaches(places.size(), reach);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].allFinite()) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&places](std::size_t a, std::size_t b) { return places[a].x() < places[b].x(); });
  std::vector<float> counts(places.size(), 1.0F);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Eigen::Vector2f& here = places[order[i]];
    for (std::size_t j = i + 1; j < order.size() && places[order[j]].x() - here.x() < reach; ++j) {
      if ((places[order[j]] - here).squaredNorm() >= reach * reach) continue;
      ++counts[order[i]];
      ++counts[order[j]];
    }
  }
  for (const std::size_t i : order) reaches[i] *= std::min(1.0F, kSparse / counts[i]);
  return reaches;
}

}  // namespace radar_dot
