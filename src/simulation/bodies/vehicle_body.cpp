// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/vehicle_body.h"

#include <algorithm>
#include <cmath>

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kQuarterTurn = 1.57079632679F;

/// Points from the middle of an end to where the straight side begins; `end` = 1 front, -1 rear.
std::vector<Vector3f> endPoints(float end_x, float end, float half_width, float corner, float corner_width,
                                float bulge) {
  std::vector<Vector3f> points;
  const float straight = half_width - corner_width;
  const float fall = bulge * (straight / half_width) * (straight / half_width);
  for (int i = 0; i < Shell::kFrontCells; ++i) {
    const float y = straight * static_cast<float>(i) / Shell::kFrontCells;
    points.emplace_back(end_x - end * bulge * (y / half_width) * (y / half_width), y, 0.0F);
  }
  for (int i = 0; i <= Shell::kCornerCells; ++i) {
    const float angle = kQuarterTurn * static_cast<float>(i) / Shell::kCornerCells;
    points.emplace_back(end_x - end * (fall + corner * (1.0F - std::cos(angle))),
                        straight + corner_width * std::sin(angle), 0.0F);
  }
  return points;
}

}  // namespace

int Shell::add(const Outline& outline, const HeightAt& height, float scale) {
  std::vector<Vector3f> half = endPoints(outline.front_x, 1.0F, outline.half_width, outline.front_corner,
                                         outline.front_corner_width, outline.front_bulge);
  const std::vector<Vector3f> rear = endPoints(outline.rear_x, -1.0F, outline.half_width, outline.rear_corner,
                                               outline.rear_corner_width, outline.rear_bulge);
  for (const float x : outline.side_x)
    half.emplace_back(
        std::clamp(x, rear.back().x(), half[static_cast<std::size_t>(kFrontCells + kCornerCells)].x()),
        outline.half_width, 0.0F);
  half.insert(half.end(), rear.rbegin(), rear.rend());
  std::vector<Vector3f> loop = half;
  for (std::size_t i = half.size() - 2; i > 0; --i) loop.emplace_back(half[i].x(), -half[i].y(), 0.0F);
  for (Vector3f& point : loop) {
    point.z() = height(point);
    point.y() *= scale;
  }
  loops_.push_back(std::move(loop));
  return rows() - 1;
}

Column Shell::column(int number) const {
  const bool left = number < halfColumns();
  int index = left ? number : columns() - 1 - number;
  if (index < kFrontCells) return {Zone::kFront, index, left};
  index -= kFrontCells;
  if (index < kCornerCells) return {Zone::kFrontCorner, index, left};
  index -= kCornerCells;
  if (index <= side_stations_) return {Zone::kSide, index, left};
  index -= side_stations_ + 1;
  if (index < kCornerCells) return {Zone::kRearCorner, kCornerCells - 1 - index, left};
  return {Zone::kRear, kFrontCells - 1 - (index - kCornerCells), left};
}

Vector3f Shell::point(int row, int column) const {
  return loops_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column % columns())];
}

void Shell::build(MeshBuilder& builder,
                  const std::function<std::uint32_t(int, const Column&)>& surface_of) const {
  std::vector<Vector3f> points;
  for (const auto& loop : loops_) points.insert(points.end(), loop.begin(), loop.end());
  builder.grid(
      points, rows(), columns(), [&](int row, int number) { return surface_of(row, column(number)); }, true);
}

float crownShare(const Vector3f& point, const Outline& outline, float scale) {
  const float across = point.y() / outline.half_width;
  return across * across * (1.0F - scale * scale);
}

float WheelArches::lowest(float x) const {
  float result = 0.0F;
  for (const float axle : axles) {
    const float across = (x - axle) / radius;
    if (std::abs(across) < 1.0F)
      result = std::max(result, centre_z + radius * std::sqrt(1.0F - across * across));
  }
  return result;
}

float WheelArches::lift(float x, float z, float bottom, float top) const {
  const float low = std::max(bottom, lowest(x));
  if (low <= bottom || z >= top) return z;
  return low + (z - bottom) * (top - low) / (top - bottom);
}

std::vector<float> WheelArches::stations(float front_x, float rear_x, float step,
                                         std::vector<float> extra) const {
  constexpr int kArchCells = 10;
  std::vector<float> wanted;
  for (const float axle : axles) {
    wanted.push_back(axle + radius * 1.002F);
    wanted.push_back(axle - radius * 1.002F);
    for (int i = 0; i <= kArchCells; ++i)
      wanted.push_back(axle +
                       radius * 0.999F * std::cos(2.0F * kQuarterTurn * static_cast<float>(i) / kArchCells));
  }
  wanted.insert(wanted.end(), extra.begin(), extra.end());
  const auto inside = [&](float x) { return x < front_x && x > rear_x; };
  wanted.erase(std::remove_if(wanted.begin(), wanted.end(), [&](float x) { return !inside(x); }),
               wanted.end());
  std::vector<float> result = wanted;
  for (float x = front_x - step; x > rear_x; x -= step) {
    const bool near = std::any_of(wanted.begin(), wanted.end(),
                                  [&](float other) { return std::abs(other - x) < 0.5F * step; });
    if (!near) result.push_back(x);
  }
  std::sort(result.begin(), result.end(), std::greater<>());
  return result;
}

}  // namespace radar_dot::simulation
