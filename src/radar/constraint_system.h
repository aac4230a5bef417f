// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace radar_dot {

/// A linear system A x = b in columns, so that the residuals of one hypothesis are a few vector
/// instructions per column. Keeps its memory when it shrinks.
struct ConstraintSystem {
  static constexpr int kMaxParameters = 4;

  int parameters = 0;
  std::size_t rows = 0;
  std::array<std::vector<float>, kMaxParameters> columns;
  std::vector<float> right_hand_side;  ///< b = -d, m/s
  std::vector<float> variance;         ///< of a row, (m/s)^2

  void resize(int parameter_count, std::size_t row_count);

  using ConstColumn = Eigen::Map<const Eigen::ArrayXf>;
  ConstColumn column(int i) const {
    return {columns[static_cast<std::size_t>(i)].data(), static_cast<Eigen::Index>(rows)};
  }
  ConstColumn rightHandSide() const { return {right_hand_side.data(), static_cast<Eigen::Index>(rows)}; }
};

/// A solution in the parameters of a system; the unused entries are zero.
using Parameters = Eigen::Matrix<double, ConstraintSystem::kMaxParameters, 1>;
using ParameterMatrix =
    Eigen::Matrix<double, ConstraintSystem::kMaxParameters, ConstraintSystem::kMaxParameters>;

/// Memory the solvers keep between calls.
struct SolverScratch {
  std::vector<float> residuals;
  std::vector<float> weights;
};

/// e = A x - b, one value per row. For b = -d this is the paper's residual d + u.v with its sign.
void evaluateResiduals(const ConstraintSystem& system, const Parameters& solution,
                       std::vector<float>& residuals);

/// Which directions of the parameter space the rows constrain.
struct Observability {
  int rank = 0;
  double condition_number = 0.0;  ///< of the unweighted design matrix; infinite when rank-deficient
  /// Orthonormal columns: the constrained directions first, then the free ones. Identity at full rank.
  ParameterMatrix basis = ParameterMatrix::Identity();
};

/// Directions whose singular value lies more than `max_condition_number` below the largest count as free.
Observability analyseObservability(const ConstraintSystem& system, double max_condition_number);

/// The system in the coordinates of the first `rank` columns of `basis`: A V, b.
void projectSystem(const ConstraintSystem& system, const Observability& observability,
                   ConstraintSystem& projected);

/// Parameters of solveRansac.
struct RansacParams {
  std::uint64_t seed = 1;
  int iterations = 100;
  double inlier_threshold = 0.3;  ///< m/s
  /// Size of the one column that is not made of unit vectors: m, the largest lever arm, of the yaw rate.
  /// Which samples are too close to parallel does not depend on it.
  double lever_arm = 1.0;
};

/// Least squares over all rows. All solvers return false when the system is singular.
bool solveLeastSquares(const ConstraintSystem& system, Parameters& solution, SolverScratch& scratch);

/// Least squares over the rows that `solution` explains within `threshold` (m/s).
bool solveInliers(const ConstraintSystem& system, double threshold, Parameters& solution,
                  SolverScratch& scratch);

/// Consensus by minimal samples, scored with the truncated quadratic of MSAC (Torr & Zisserman 2000);
/// each new best is polished by least squares on its inliers (LO-RANSAC, Chum et al. 2003).
bool solveRansac(const ConstraintSystem& system, const RansacParams& params, Parameters& solution,
                 SolverScratch& scratch);

/// Iteratively reweighted least squares with Cauchy weights 1 / (sigma^2 + e^2), from `solution`.
bool refineRobust(const ConstraintSystem& system, int iterations, Parameters& solution,
                  SolverScratch& scratch);

/// Information matrix A' W A over the rows with |residual| < threshold, W = 1 / variance.
ParameterMatrix inlierInformation(const ConstraintSystem& system, const std::vector<float>& residuals,
                                  double threshold, SolverScratch& scratch);

}  // namespace radar_dot
