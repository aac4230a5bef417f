// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "radar_dot/simulation/mesh.h"

namespace radar_dot::simulation {

/// A vehicle seen from above: a rounded rectangle, symmetric about the x axis.
struct Outline {
  float front_x = 2.0F;
  float rear_x = -2.0F;
  float half_width = 0.85F;
  float front_corner = 0.3F;        ///< m along x; as wide as front_corner_width along y
  float front_corner_width = 0.3F;  ///< m
  float rear_corner = 0.2F;
  float rear_corner_width = 0.25F;
  float front_bulge = 0.05F;  ///< m that the middle of the front is ahead of its ends
  float rear_bulge = 0.03F;
  std::vector<float> side_x;  ///< stations along the straight side, front to rear
};

/// Where a column of cells of a shell lies.
enum class Zone { kFront, kFrontCorner, kSide, kRearCorner, kRear };
struct Column {
  Zone zone = Zone::kFront;
  int index = 0;  ///< within its zone, from the front middle backwards; a side has stations + 1 cells
  bool left = true;
};

/// A skin through closed loops stacked bottom to top. All outlines of one shell have the same number
/// of side stations.
class Shell {
 public:
  using HeightAt = std::function<float(const Eigen::Vector3f& point)>;
  static constexpr int kFrontCells = 5;
  static constexpr int kCornerCells = 4;

  explicit Shell(int side_stations) : side_stations_(side_stations) {}

  /// Adds a loop. `scale` < 1 shrinks it across the vehicle, to close floors and roofs.
  /// Returns its number.
  int add(const Outline& outline, const HeightAt& height, float scale = 1.0F);
  int rows() const { return static_cast<int>(loops_.size()); }
  int columns() const { return 2 * halfColumns(); }
  Column column(int number) const;
  Eigen::Vector3f point(int row, int column) const;

  /// `surface_of(row, column)`: number of the surface of the cell above loop `row`.
  void build(MeshBuilder& builder,
             const std::function<std::uint32_t(int row, const Column& column)>& surface_of) const;

 private:
  int halfColumns() const { return 2 * kFrontCells + 2 * kCornerCells + side_stations_ + 1; }

  int side_stations_;
  std::vector<std::vector<Eigen::Vector3f>> loops_;
};

/// How much of the crown of a deck or roof a point of a loop has that is shrunk by `scale`: none at the
/// ends, where all loops meet, nor at the edge.
float crownShare(const Eigen::Vector3f& point, const Outline& outline, float scale);

/// Round openings for wheels, cut into the lower loops.
struct WheelArches {
  std::vector<float> axles;  ///< x, m
  float centre_z = 0.32F;
  float radius = 0.36F;

  /// Lowest allowed height of the skin at x; 0 beside the openings.
  float lowest(float x) const;
  /// Squeezes the height of a point of the side between the opening and `top` (m).
  float lift(float x, float z, float bottom, float top) const;
  /// Stations along a side: the edges of the openings dense, the rest about `step` apart, and those of
  /// `extra`.
  std::vector<float> stations(float front_x, float rear_x, float step, std::vector<float> extra) const;
};

}  // namespace radar_dot::simulation
