// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/uncertainty_terms.h"

#include <Eigen/Cholesky>
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

MotionSpread::MotionSpread(const Eigen::Matrix<double, 6, 6>& covariance) : none(covariance.isZero(0.0)) {
  if (none) return;
  // Semi-definite where some of the motion is exact, which a plain Cholesky factor does not stand.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(covariance);
  if (!covariance.allFinite() || solver.eigenvalues().minCoeff() < -1e-9 * solver.eigenvalues().maxCoeff())
    throw std::invalid_argument("motion segmentation: the covariance of the motion is no covariance");
  const Eigen::Matrix<double, 6, 6> root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  // root root^T = L L^T with L = R^T of the QR decomposition of root^T.
  const Eigen::Matrix<double, 6, 6> upper =
      root.transpose().eval().householderQr().matrixQR().triangularView<Eigen::Upper>();
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column) lower[row][column] = static_cast<float>(upper(column, row));
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
