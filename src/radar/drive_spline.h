// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace radar_dot {

/// Uniform cubic B-spline over time of a velocity [vx, vy, yaw rate].
class DriveSpline {
 public:
  /// Where a time lies: the first of its four coefficients, their weights, and the rates of those.
  struct Place {
    Eigen::Index first = 0;
    Eigen::Vector4d weights, rates;
  };

  DriveSpline(double begin, double end, double interval)
      : begin_(begin),
        interval_(interval),
        pieces_(std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::ceil((end - begin) / interval)))),
        coefficients_(Eigen::Matrix3Xd::Zero(3, pieces_ + 3)) {}

  /// Times beyond the ends are those of the ends.
  Place at(double time) const {
    const double s = std::clamp((time - begin_) / interval_, 0.0, static_cast<double>(pieces_) - 1e-9);
    const double u = s - std::floor(s);
    const double v = 1.0 - u;
    Place place;
    place.first = static_cast<Eigen::Index>(s);
    place.weights << v * v * v, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * v * v * v - 6.0 * v * v + 4.0,
        u * u * u;
    place.weights /= 6.0;
    place.rates << -v * v, 3.0 * u * u - 4.0 * u, -3.0 * v * v + 4.0 * v, u * u;
    place.rates /= 2.0 * interval_;
    return place;
  }
  Eigen::Vector3d velocity(const Place& place) const {
    return coefficients_.middleCols<4>(place.first) * place.weights;
  }
  Eigen::Vector3d acceleration(const Place& place) const {
    return coefficients_.middleCols<4>(place.first) * place.rates;
  }
  double knot(Eigen::Index piece) const { return begin_ + interval_ * static_cast<double>(piece); }
  Eigen::Index pieces() const { return pieces_; }
  Eigen::Matrix3Xd& coefficients() { return coefficients_; }
  const Eigen::Matrix3Xd& coefficients() const { return coefficients_; }

 private:
  double begin_, interval_;
  Eigen::Index pieces_;
  Eigen::Matrix3Xd coefficients_;  // by column
};

}  // namespace radar_dot
