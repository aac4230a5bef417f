// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/uncertainty_terms.h"

#include <Eigen/Eigenvalues>
#include <stdexcept>

namespace radar_dot::uncertainty_terms {
namespace {

/// Probability that s exceeds t.
double exceedance(int degrees, double t) {
  const double tail = std::exp(-0.5 * t * t);
  if (degrees == 2) return tail;
  return std::erfc(t / std::sqrt(2.0)) + std::sqrt(2.0 / M_PI) * t * tail;
}

}  // namespace

std::vector<SmallMotion> spreadOf(const Eigen::Matrix<double, 6, 6>& covariance) {
  std::vector<SmallMotion> spread;
  if (covariance.isZero(0.0)) return spread;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(covariance);
  const double largest = solver.eigenvalues().maxCoeff();
  constexpr double kRounding = 1e-9;
  if (!covariance.allFinite() || solver.eigenvalues().minCoeff() < -kRounding * largest)
    throw std::invalid_argument("motion segmentation: the covariance of the motion is no covariance");
  for (int i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] <= kRounding * largest) continue;
    const Eigen::Matrix<float, 6, 1> axis =
        (std::sqrt(solver.eigenvalues()[i]) * solver.eigenvectors().col(i)).cast<float>();
    spread.push_back({axis[0], axis[1], axis[2], axis[3], axis[4], axis[5]});
  }
  return spread;
}

double chiThreshold(int degrees, double false_alarm) {
  if (degrees != 2 && degrees != 3) throw std::invalid_argument("chi-square: 2 or 3 degrees of freedom");
  if (!(false_alarm > 0.0 && false_alarm < 1.0))
    throw std::invalid_argument("chi-square: the probability must lie between 0 and 1");
  double below = 0.0;
  double above = 40.0;  // less than any number that is not zero
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (below + above);
    (exceedance(degrees, middle) > false_alarm ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

double chiMedian(int degrees) { return chiThreshold(degrees, 0.5); }

}  // namespace radar_dot::uncertainty_terms
