// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kPi = 3.141592653589793;
constexpr double kPieceLength = 1.0;  // m
constexpr double kPieceTurn = 0.15;   // rad

Vector2d unit(double heading) { return {std::cos(heading), std::sin(heading)}; }

/// From the corner of two lines to where a bend of length 1 begins.
double cornerShare(double turn, double ramp) {
  const Vector2d chord = [&] {
    Path bend(Vector2d::Zero(), 0.0);
    bend.bend(1.0, turn, ramp);
    return bend.at(1.0).position;
  }();
  return chord.x() / (1.0 + std::cos(turn));
}

}  // namespace

double Path::Segment::headingAt(double along) const noexcept {
  if (turn == 0.0 || length <= 0.0) return heading;
  const double x = along / length;
  const double peak = turn / (1.0 - ramp);
  const auto rising = [&](double share) {
    return 0.5 * peak * (share - ramp / kPi * std::sin(kPi * share / ramp));
  };
  if (x < ramp) return heading + rising(x);
  if (x > 1.0 - ramp) return heading + turn - rising(1.0 - x);
  return heading + peak * (x - 0.5 * ramp);
}

double Path::Segment::curvatureAt(double along) const noexcept {
  if (turn == 0.0 || length <= 0.0) return 0.0;
  const double x = along / length;
  const double edge = std::min(x, 1.0 - x);
  const double peak = turn / (1.0 - ramp) / length;
  return edge < ramp ? 0.5 * peak * (1.0 - std::cos(kPi * edge / ramp)) : peak;
}

Path::Path(const Vector2d& start, double heading) : end_(start), end_heading_(heading) {
  segments_.push_back({0.0, 0.0, heading, 0.0, kRamp});
  pieces_.push_back({0.0, start, 0});
}

Path& Path::straight(double length) { return bend(length, 0.0); }

Path& Path::bend(double length, double turn, double ramp) {
  if (!(length >= 0.0)) throw std::invalid_argument("Path: a length is negative");
  if (!(ramp >= 0.0 && ramp <= 0.5)) throw std::invalid_argument("Path: ramp must be from 0 to 0.5");
  if (length == 0.0) return *this;
  segments_.push_back({length_, length, end_heading_, turn, ramp});
  const Segment& segment = segments_.back();
  // No piece reaches over a change of the law of the curvature: there the quadrature would suffer.
  const auto divide = [&](double from, double to) {
    const double turned = std::abs(segment.headingAt(to) - segment.headingAt(from));
    const double share = turn == 0.0 ? 1.0 : std::max((to - from) / kPieceLength, turned / kPieceTurn);
    const int pieces = std::max(1, static_cast<int>(std::ceil(share)));
    const double step = (to - from) / pieces;
    for (int i = 0; i < pieces && step > 0.0; ++i) {
      pieces_.push_back({length_ + from + i * step, end_, segments_.size() - 1});
      end_ += advance(segment, from + i * step, from + (i + 1) * step);
    }
  };
  if (turn == 0.0) {
    divide(0.0, length);
  } else {
    divide(0.0, ramp * length);
    divide(ramp * length, (1.0 - ramp) * length);
    divide((1.0 - ramp) * length, length);
  }
  end_heading_ += turn;
  length_ += length;
  return *this;
}

Path Path::through(const std::vector<Vector2d>& waypoints, double radius) {
  if (waypoints.size() < 2) throw std::invalid_argument("Path: at least two waypoints are needed");
  std::vector<double> legs;
  std::vector<Vector2d> directions;
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const Vector2d leg = waypoints[i + 1] - waypoints[i];
    if (!(leg.norm() > 0.0)) throw std::invalid_argument("Path: two waypoints in one place");
    legs.push_back(leg.norm());
    directions.push_back(leg.normalized());
  }
  Path path(waypoints.front(), std::atan2(directions[0].y(), directions[0].x()));
  double used = 0.0;  // of the present leg, by the bend before
  for (std::size_t i = 0; i + 1 < legs.size(); ++i) {
    const Vector2d& before = directions[i];
    const Vector2d& after = directions[i + 1];
    const double turn = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
    if (std::abs(turn) < 1e-9) {
      path.straight(legs[i] - used);
      used = 0.0;
      continue;
    }
    const double share = cornerShare(turn, kRamp);
    const double wanted = radius * std::abs(turn) / (1.0 - kRamp);
    const double room =
        std::min(i == 0 ? legs[i] : 0.5 * legs[i], i + 2 == legs.size() ? legs[i + 1] : 0.5 * legs[i + 1]);
    const double length = std::min(wanted, room / share);
    path.straight(std::max(0.0, legs[i] - used - share * length));
    path.bend(length, turn);
    used = share * length;
  }
  path.straight(std::max(0.0, legs.back() - used));
  return path;
}

Vector2d Path::advance(const Segment& segment, double from, double to) const noexcept {
  if (segment.turn == 0.0) return (to - from) * unit(segment.heading);
  // Gauss-Legendre with 5 nodes: errors below 1e-12 m over a piece.
  static constexpr std::array<double, 5> kNodes = {-0.9061798459386640, -0.5384693101056831, 0.0,
                                                   0.5384693101056831, 0.9061798459386640};
  static constexpr std::array<double, 5> kWeights = {
      0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = 0; i < kNodes.size(); ++i)
    sum += kWeights[i] * unit(segment.headingAt(0.5 * (from + to) + 0.5 * (to - from) * kNodes[i]));
  return 0.5 * (to - from) * sum;
}

PathPoint Path::at(double along) const noexcept {
  if (along <= 0.0) {
    const Segment& first = segments_.front();
    return {pieces_.front().position + along * unit(first.heading), first.heading, 0.0};
  }
  if (along >= length_) return {end_ + (along - length_) * unit(end_heading_), end_heading_, 0.0};
  const auto next = std::upper_bound(pieces_.begin(), pieces_.end(), along,
                                     [](double value, const Piece& piece) { return value < piece.begin; });
  const Piece& piece = *(next - 1);
  const Segment& segment = segments_[piece.segment];
  const double local = along - segment.begin;
  return {piece.position + advance(segment, piece.begin - segment.begin, local), segment.headingAt(local),
          segment.curvatureAt(local)};
}

}  // namespace radar_dot::simulation
