// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace radar_dot::simulation {

inline constexpr double kKerbHeight = 0.12;   ///< m
inline constexpr double kKerbWidth = 0.15;    ///< m
inline constexpr double kGutterWidth = 0.35;  ///< m
/// m, with the kerb. The same everywhere, and the radius of the corners: so pavements meet at crossings.
inline constexpr double kPavementWidth = 4.2;
inline constexpr double kPlotDepth = 36.0;  ///< m, of the ground behind the pavement

/// Cross-section of a street; both halves are alike.
struct StreetProfile {
  double lane_width = 3.3;    ///< m
  int lanes = 1;              ///< per direction
  double cycle_lane = 0.0;    ///< m; 0: none
  double parking = 2.2;       ///< m; 0: none
  double front_garden = 2.5;  ///< m, between pavement and houses

  double halfRoad() const { return lanes * lane_width + cycle_lane + parking + kGutterWidth; }
  double houseLine() const { return halfRoad() + kPavementWidth + front_garden; }
  /// y of a lane's centre in the street's direction; lane 0 is next to the middle. Drive on the right.
  double laneY(int lane = 0) const { return -(lane + 0.5) * lane_width; }
  double cycleY() const { return -(lanes * lane_width + 0.5 * cycle_lane); }
  double parkingY() const { return -(lanes * lane_width + cycle_lane + 0.5 * parking); }
};

/// A straight street. Its frame: x along it from its start, y to the left, z up.
struct Street {
  Eigen::Isometry3d T_map_from_street = Eigen::Isometry3d::Identity();
  double length = 100.0;  ///< m
  StreetProfile profile;
  double parked_share = 0.75;  ///< of the parking places that are taken
  double tree_share = 0.7;     ///< of the places for trees that have one
  bool closed_start = true;    ///< houses across the end
  bool closed_end = true;
  bool priority = true;        ///< its plots go through; those of a crossing street begin behind them
  std::vector<double> zebras;  ///< m along the street, middle of a pedestrian crossing
  struct Gap {
    double low = 0.0, high = 0.0;  ///< m along the street
  };
  std::vector<Gap> junctions;   ///< where the road of a crossing street and its corners are
  std::vector<Gap> kept_clear;  ///< without parked cars and things on the pavement

  Eigen::Vector2d place(double x, double y) const {
    return (T_map_from_street * Eigen::Vector3d(x, y, 0.0)).head<2>();
  }
  /// Stretches between `low` and `high` outside the gaps.
  static std::vector<Gap> free(double low, double high, std::vector<Gap> gaps);
};

struct Junction {
  std::size_t main = 0, cross = 0;       ///< numbers in StreetPlan::streets
  double on_main = 0.0, on_cross = 0.0;  ///< m along each
  bool signals = true;                   ///< traffic lights, stop lines and zebras at all four arms
};

inline constexpr double kZebraWidth = 3.2;     ///< m, along the street
inline constexpr double kStopLineWidth = 0.4;  ///< m

/// Streets and where they cross, at right angles.
struct StreetPlan {
  std::vector<Street> streets;
  std::vector<Junction> junctions;

  /// Adds a street that crosses `main` from right to left at `on_main`, itself crossed at `on_cross`.
  /// Returns its number.
  std::size_t cross(std::size_t main, double on_main, const Street& street, double on_cross, bool signals);
  /// 0 on a road, the height of the kerb elsewhere.
  double groundHeight(const Eigen::Vector2d& place) const;
};

/// Distance of the middle of a zebra, and of the stop line, from the middle of a junction with a road of
/// this half width, m.
inline double zebraDistance(double half_road) { return half_road + kPavementWidth + 0.8 + 0.5 * kZebraWidth; }
inline double stopLineDistance(double half_road) {
  return zebraDistance(half_road) + 0.5 * kZebraWidth + 1.0;
}

}  // namespace radar_dot::simulation
