// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/building_front.h"

namespace radar_dot::simulation {

using Eigen::Vector3f;

void BuildingFront::wall(const Opening& area) {
  if (area.right - area.left < 1e-4F || area.top - area.bottom < 1e-4F) return;
  sheet(area, 0.0F);
}

void BuildingFront::wallAround(const Opening& bay, const Opening& hole, const Surface& surface,
                               float setback) {
  builder_.use(surface);
  wall({bay.left, hole.left, bay.bottom, bay.top});
  wall({hole.right, bay.right, bay.bottom, bay.top});
  wall({hole.left, hole.right, bay.bottom, hole.bottom});
  wall({hole.left, hole.right, hole.top, bay.top});
  const auto at = [](float x, float y, float z) { return Vector3f(x, y, z); };
  builder_.quad(at(hole.left, 0, hole.top), at(hole.left, -setback, hole.top),
                at(hole.left, -setback, hole.bottom), at(hole.left, 0, hole.bottom));
  builder_.quad(at(hole.right, -setback, hole.top), at(hole.right, 0, hole.top),
                at(hole.right, 0, hole.bottom), at(hole.right, -setback, hole.bottom));
  builder_.quad(at(hole.left, -setback, hole.bottom), at(hole.right, -setback, hole.bottom),
                at(hole.right, 0, hole.bottom), at(hole.left, 0, hole.bottom));
  builder_.quad(at(hole.left, 0, hole.top), at(hole.right, 0, hole.top), at(hole.right, -setback, hole.top),
                at(hole.left, -setback, hole.top));
}

void BuildingFront::glazing(const Opening& hole, const Surface& pane, float setback, int mullions,
                            float transom_share) {
  builder_.use(pane);
  sheet(hole, -setback);
  builder_.use(frame_);
  constexpr float kFrame = 0.055F;
  const float front = -setback + 0.04F;
  block({hole.left, hole.left + kFrame, hole.bottom, hole.top}, -setback, front);
  block({hole.right - kFrame, hole.right, hole.bottom, hole.top}, -setback, front);
  block({hole.left + kFrame, hole.right - kFrame, hole.bottom, hole.bottom + kFrame}, -setback, front);
  block({hole.left + kFrame, hole.right - kFrame, hole.top - kFrame, hole.top}, -setback, front);
  for (int i = 1; i <= mullions; ++i) {
    const float x = hole.left + hole.width() * static_cast<float>(i) / static_cast<float>(mullions + 1);
    block({x - 0.03F, x + 0.03F, hole.bottom + kFrame, hole.top - kFrame}, -setback, front - 0.01F);
  }
  if (transom_share <= 0.0F) return;
  const float z = hole.bottom + transom_share * (hole.top - hole.bottom);
  block({hole.left + kFrame, hole.right - kFrame, z - 0.025F, z + 0.025F}, -setback, front - 0.015F);
}

void BuildingFront::block(const Opening& area, float back, float front) {
  builder_.box({area.left, back, area.bottom}, {area.right, front, area.top});
}

void BuildingFront::sheet(const Opening& area, float y) {
  builder_.quad({area.right, y, area.bottom}, {area.left, y, area.bottom}, {area.left, y, area.top},
                {area.right, y, area.top});
}

}  // namespace radar_dot::simulation
