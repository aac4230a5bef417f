// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/street/ground_batch.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace radar_dot::simulation {
namespace {

constexpr double kChunk = 40.0;  // m
constexpr double kTile = 10.0;   // m
// m: tiles of different meshes are rounded apart by up to 0.1 mm, and no ray may fall between.
constexpr double kOverlap = 0.002;

bool same(const Surface& a, const Surface& b) {
  return a.material == b.material && a.palette_slot == b.palette_slot && (a.color == b.color).all();
}

Eigen::Vector3f lifted(const Eigen::Vector2d& place, double z) {
  return {static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(z)};
}

}  // namespace

void putStatic(World& world, std::shared_ptr<const Mesh> mesh, const Eigen::Isometry3d& T_map_from_object) {
  world.statics.push_back({std::move(mesh), T_map_from_object, plainPalette()});
}

MeshBuilder& GroundBatch::builderAt(const Eigen::Vector2d& place, Eigen::Vector2d& origin) {
  const std::pair<int, int> key = {static_cast<int>(std::floor(place.x() / kChunk)),
                                   static_cast<int>(std::floor(place.y() / kChunk))};
  origin = kChunk * Eigen::Vector2d(key.first, key.second);
  Chunk& chunk = chunks_[key];
  if (chunk.fresh || !same(chunk.surface, surface_)) chunk.builder.use(surface_);
  chunk.fresh = false;
  chunk.surface = surface_;
  return chunk.builder;
}

void GroundBatch::quad(const std::array<Eigen::Vector2d, 4>& corners, double z) {
  const Eigen::Vector2d first = corners[2] - corners[0];
  const Eigen::Vector2d second = corners[3] - corners[1];
  const bool upward = first.x() * second.y() > first.y() * second.x();
  Eigen::Vector2d origin;
  MeshBuilder& builder = builderAt(0.25 * (corners[0] + corners[1] + corners[2] + corners[3]), origin);
  std::array<Eigen::Vector3f, 4> points;
  for (std::size_t i = 0; i < 4; ++i) points[i] = lifted(corners[upward ? i : 3 - i] - origin, z);
  builder.quad(points[0], points[1], points[2], points[3]);
}

void GroundBatch::rectangle(double x0, double x1, double y0, double y1, double z) {
  quad({Eigen::Vector2d(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}}, z);
}

void GroundBatch::strip(double x0, double x1, double y0, double y1, double z) {
  const int tiles = std::max(1, static_cast<int>(std::ceil((x1 - x0) / kTile)));
  for (int i = 0; i < tiles; ++i)
    rectangle(x0 + (x1 - x0) * i / tiles, x0 + (x1 - x0) * (i + 1) / tiles + kOverlap, y0, y1, z);
}

void GroundBatch::disc(const Eigen::Vector2d& centre, double radius, double z) {
  constexpr int kSides = 16;
  const auto rim = [&](int side) {
    const double angle = 6.283185307179586 * side / kSides;
    return Eigen::Vector2d(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  };
  for (int side = 0; side < kSides; side += 2) quad({centre, rim(side), rim(side + 1), rim(side + 2)}, z);
}

void GroundBatch::wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double bottom, double top) {
  Eigen::Vector2d origin;
  MeshBuilder& builder = builderAt(0.5 * (from + to), origin);
  builder.quad(lifted(from - origin, bottom), lifted(to - origin, bottom), lifted(to - origin, top),
               lifted(from - origin, top));
}

void GroundBatch::moveTo(World& world) {
  for (auto& [key, chunk] : chunks_) {
    const Eigen::Translation3d origin(kChunk * key.first, kChunk * key.second, 0.0);
    putStatic(world, std::make_shared<Mesh>(std::move(chunk.builder).build()), T_map_from_street_ * origin);
  }
  chunks_.clear();
}

}  // namespace radar_dot::simulation
