// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace radar_dot::simulation {

/// A place on a path.
struct PathPoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< m
  double heading = 0.0;                                ///< rad, from x to y
  double curvature = 0.0;                              ///< 1/m, positive to the left
};

/// A line in the plane, parametrised by its length: straights and bends whose curvature and its slope
/// are continuous. In a bend the curvature rises over the first part like half a cosine, stays, and
/// falls in the same way. Goes on straight before its start and after its end.
class Path {
 public:
  Path(const Eigen::Vector2d& start, double heading);

  Path& straight(double length);
  /// Turns by `turn` rad (positive to the left) over `length` m. @param ramp fraction of the length over
  /// which the curvature rises, and again falls: 0 (an arc of a circle) to 0.5.
  Path& bend(double length, double turn, double ramp = kRamp);

  /// Straights through the waypoints, joined by bends that are at their narrowest about `radius` m,
  /// or less where the waypoints are too near to each other.
  /// @throws std::invalid_argument for fewer than two waypoints or two in one place.
  static Path through(const std::vector<Eigen::Vector2d>& waypoints, double radius);

  double length() const noexcept { return length_; }
  PathPoint at(double along) const noexcept;

  static constexpr double kRamp = 0.35;

 private:
  /// A stretch short enough for one quadrature.
  struct Piece {
    double begin = 0.0;                                  ///< m, along the path
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< there
    std::size_t segment = 0;
  };
  struct Segment {
    double begin = 0.0, length = 0.0;
    double heading = 0.0, turn = 0.0, ramp = 0.0;
    double headingAt(double along) const noexcept;
    double curvatureAt(double along) const noexcept;
  };
  Eigen::Vector2d advance(const Segment& segment, double from, double to) const noexcept;

  std::vector<Segment> segments_;
  std::vector<Piece> pieces_;
  double length_ = 0.0;
  Eigen::Vector2d end_;
  double end_heading_;
};

}  // namespace radar_dot::simulation
