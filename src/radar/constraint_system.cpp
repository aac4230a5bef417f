// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "constraint_system.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "radar_dot/common/random_stream.h"

namespace radar_dot {
namespace {

using Array = Eigen::Map<Eigen::ArrayXf>;
using ConstArray = Eigen::Map<const Eigen::ArrayXf>;
template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// Uniform in [0, bound), bound < 2^32.
  std::size_t below(std::size_t bound) {
    const std::uint64_t bits = mixBits(state_);
    state_ += kRandomStep;
    return static_cast<std::size_t>(((bits >> 32) * bound) >> 32);
  }

 private:
  std::uint64_t state_;
};

/// Calls `body` with the number of parameters as a compile-time constant.
template <typename Body>
auto dispatch(int parameters, Body&& body) {
  switch (parameters) {
    case 1: return body(std::integral_constant<int, 1>{});
    case 2: return body(std::integral_constant<int, 2>{});
    case 3: return body(std::integral_constant<int, 3>{});
    default: return body(std::integral_constant<int, ConstraintSystem::kMaxParameters>{});
  }
}

ConstArray mapped(const std::vector<float>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

Array resized(std::vector<float>& values, std::size_t size) {
  values.resize(size);
  return {values.data(), static_cast<Eigen::Index>(size)};
}

/// A x - b over `count` rows from `first`, as a lazy expression in single precision.
template <int N>
auto residualExpression(const ConstraintSystem& system, const Parameters& x, Eigen::Index first,
                        Eigen::Index count) {
  const Eigen::Vector4f f = x.cast<float>();
  const auto rhs = system.rightHandSide().segment(first, count);
  const auto column = [&](int k) { return system.column(k).segment(first, count); };
  if constexpr (N == 1) {
    return column(0) * f[0] - rhs;
  } else if constexpr (N == 2) {
    return column(0) * f[0] + column(1) * f[1] - rhs;
  } else if constexpr (N == 3) {
    return column(0) * f[0] + column(1) * f[1] + column(2) * f[2] - rhs;
  } else {
    return column(0) * f[0] + column(1) * f[1] + column(2) * f[2] + column(3) * f[3] - rhs;
  }
}

template <int N>
Vector<N> row(const ConstraintSystem& system, std::size_t i) {
  Vector<N> result;
  for (int k = 0; k < N; ++k) result[k] = static_cast<double>(system.columns[static_cast<std::size_t>(k)][i]);
  return result;
}

/// A' W A, summed in vector instructions.
template <int N>
Matrix<N> informationMatrix(const ConstraintSystem& system, const ConstArray& weights) {
  Matrix<N> information;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      information(i, j) = information(j, i) =
          static_cast<double>((weights * system.column(i) * system.column(j)).sum());
    }
  }
  return information;
}

/// One weighted least-squares step from x, whose residuals are e = A x - b:
///     x <- x - (A' W A)^-1 A' W e.
/// A step instead of a fresh solution keeps the rounding of single precision relative to the
/// residuals, however fast the vehicle is.
template <int N>
bool stepWeighted(const ConstraintSystem& system, const SolverScratch& scratch, Parameters& x) {
  const ConstArray weights = mapped(scratch.weights);
  const ConstArray residuals = mapped(scratch.residuals);
  Vector<N> gradient;
  for (int i = 0; i < N; ++i) {
    gradient[i] = static_cast<double>((weights * system.column(i) * residuals).sum());
  }
  const Eigen::LDLT<Matrix<N>> factors(informationMatrix<N>(system, weights));
  const Vector<N> diagonal = factors.vectorD();
  if (factors.info() != Eigen::Success || !(diagonal.minCoeff() > 1e-6 * diagonal.maxCoeff())) return false;
  const Vector<N> step = factors.solve(gradient);
  if (!step.allFinite()) return false;
  x.template head<N>() -= step;
  return true;
}

/// Solves N rows exactly; false for samples so close to parallel that they amplify noise.
template <int N>
bool solveMinimal(const Matrix<N>& a, const Vector<N>& b, double lever_arm, Parameters& solution) {
  constexpr double kMinDeterminant = 1e-3;  // with columns of size 1
  double determinant = 0.0;
  bool invertible = false;
  Matrix<N> inverse;
  a.computeInverseAndDetWithCheck(inverse, determinant, invertible, kMinDeterminant * lever_arm);
  if (!invertible) return false;
  solution.setZero();
  solution.template head<N>() = inverse * b;
  return true;
}

/// Draws N different rows.
template <int N>
std::array<std::size_t, N> drawSample(Random& random, std::size_t rows) {
  std::array<std::size_t, N> sample{};
  for (auto entry = sample.begin(); entry != sample.end(); ++entry) {
    do {
      *entry = random.below(rows);
    } while (std::find(sample.begin(), entry, *entry) != entry);
  }
  return sample;
}

template <int N>
bool hypothesize(const ConstraintSystem& system, double lever_arm, Random& random, Parameters& hypothesis) {
  const auto sample = drawSample<N>(random, system.rows);
  Matrix<N> a;
  Vector<N> b;
  for (int k = 0; k < N; ++k) {
    const std::size_t i = sample[static_cast<std::size_t>(k)];
    a.row(k) = row<N>(system, i).transpose();
    b[k] = static_cast<double>(system.right_hand_side[i]);
  }
  return solveMinimal<N>(a, b, lever_arm, hypothesis);
}

/// Sum of min(e^2, truncation); stops early once it cannot fall below `limit` any more.
template <int N>
float truncatedCost(const ConstraintSystem& system, const Parameters& x, float truncation, float limit) {
  constexpr Eigen::Index kBlock = 64;
  const auto rows = static_cast<Eigen::Index>(system.rows);
  float cost = 0.F;
  for (Eigen::Index first = 0; first < rows && cost < limit; first += kBlock) {
    cost += residualExpression<N>(system, x, first, std::min(kBlock, rows - first))
                .square()
                .min(truncation)
                .sum();
  }
  return cost;
}

template <int N>
bool ransac(const ConstraintSystem& system, const RansacParams& params, Parameters& best,
            SolverScratch& scratch) {
  if (system.rows < static_cast<std::size_t>(N)) return false;
  Random random(params.seed);
  const auto truncation = static_cast<float>(params.inlier_threshold * params.inlier_threshold);
  float best_cost = std::numeric_limits<float>::infinity();
  for (int iteration = 0; iteration < params.iterations; ++iteration) {
    Parameters hypothesis;
    if (!hypothesize<N>(system, params.lever_arm, random, hypothesis)) continue;
    const float cost = truncatedCost<N>(system, hypothesis, truncation, best_cost);
    if (!(cost < best_cost)) continue;
    best_cost = cost;
    best = hypothesis;
    Parameters polished = hypothesis;
    if (!solveInliers(system, params.inlier_threshold, polished, scratch)) continue;
    const float polished_cost = truncatedCost<N>(system, polished, truncation, best_cost);
    if (polished_cost < best_cost) {
      best_cost = polished_cost;
      best = polished;
    }
  }
  return std::isfinite(best_cost);
}

}  // namespace

void ConstraintSystem::resize(int parameter_count, std::size_t row_count) {
  parameters = parameter_count;
  rows = row_count;
  for (auto& values : columns) values.resize(row_count);
  right_hand_side.resize(row_count);
  variance.resize(row_count);
}

void evaluateResiduals(const ConstraintSystem& system, const Parameters& solution,
                       std::vector<float>& residuals) {
  Array out = resized(residuals, system.rows);
  dispatch(system.parameters, [&](auto n) {
    out = residualExpression<decltype(n)::value>(system, solution, 0, out.size());
    return 0;
  });
}

Observability analyseObservability(const ConstraintSystem& system, double max_condition_number) {
  Observability result;
  result.condition_number = std::numeric_limits<double>::infinity();
  if (system.rows == 0) return result;
  dispatch(system.parameters, [&](auto n) {
    constexpr int N = decltype(n)::value;
    Matrix<N> information;
    for (int i = 0; i < N; ++i) {
      for (int j = i; j < N; ++j) {
        information(i, j) = information(j, i) =
            (system.column(i).template cast<double>() * system.column(j).template cast<double>()).sum();
      }
    }
    const Eigen::SelfAdjointEigenSolver<Matrix<N>> eigen(information);
    const Vector<N> values = eigen.eigenvalues().cwiseMax(0.0);  // ascending
    const double floor = values[N - 1] / (max_condition_number * max_condition_number);
    for (int k = 0; k < N; ++k) {
      if (values[k] > 0.0 && values[k] >= floor) ++result.rank;
    }
    if (result.rank == N) {
      result.condition_number = std::sqrt(values[N - 1] / values[0]);
    } else {
      for (int k = 0; k < N; ++k)
        result.basis.template block<N, 1>(0, k) = eigen.eigenvectors().col(N - 1 - k);
    }
    return 0;
  });
  return result;
}

void projectSystem(const ConstraintSystem& system, const Observability& observability,
                   ConstraintSystem& projected) {
  projected.resize(observability.rank, system.rows);
  for (int k = 0; k < observability.rank; ++k) {
    Array out = resized(projected.columns[static_cast<std::size_t>(k)], system.rows);
    out.setZero();
    for (int j = 0; j < system.parameters; ++j) {
      out += system.column(j) * static_cast<float>(observability.basis(j, k));
    }
  }
  projected.right_hand_side = system.right_hand_side;
  projected.variance = system.variance;
}

bool solveLeastSquares(const ConstraintSystem& system, Parameters& solution, SolverScratch& scratch) {
  resized(scratch.weights, system.rows).setOnes();
  solution.setZero();
  return dispatch(system.parameters, [&](auto n) {
    for (int refinement = 0; refinement < 2; ++refinement) {  // the second step removes rounding
      evaluateResiduals(system, solution, scratch.residuals);
      if (!stepWeighted<decltype(n)::value>(system, scratch, solution)) return false;
    }
    return true;
  });
}

bool solveInliers(const ConstraintSystem& system, double threshold, Parameters& solution,
                  SolverScratch& scratch) {
  evaluateResiduals(system, solution, scratch.residuals);
  resized(scratch.weights, system.rows) =
      (mapped(scratch.residuals).abs() < static_cast<float>(threshold)).cast<float>();
  return dispatch(system.parameters,
                  [&](auto n) { return stepWeighted<decltype(n)::value>(system, scratch, solution); });
}

bool solveRansac(const ConstraintSystem& system, const RansacParams& params, Parameters& solution,
                 SolverScratch& scratch) {
  return dispatch(system.parameters,
                  [&](auto n) { return ransac<decltype(n)::value>(system, params, solution, scratch); });
}

bool refineRobust(const ConstraintSystem& system, int iterations, Parameters& solution,
                  SolverScratch& scratch) {
  constexpr double kConverged = 1e-4;  // m/s: far below what the data can tell
  return dispatch(system.parameters, [&](auto n) {
    for (int iteration = 0; iteration < iterations; ++iteration) {
      evaluateResiduals(system, solution, scratch.residuals);
      resized(scratch.weights, system.rows) =
          (mapped(system.variance) + mapped(scratch.residuals).square()).inverse();
      const Parameters before = solution;
      if (!stepWeighted<decltype(n)::value>(system, scratch, solution)) return iteration > 0;
      if ((solution - before).cwiseAbs().maxCoeff() < kConverged) break;
    }
    return true;
  });
}

ParameterMatrix inlierInformation(const ConstraintSystem& system, const std::vector<float>& residuals,
                                  double threshold, SolverScratch& scratch) {
  ParameterMatrix result = ParameterMatrix::Zero();
  resized(scratch.weights, system.rows) =
      (mapped(residuals).abs() < static_cast<float>(threshold)).cast<float>() / mapped(system.variance);
  dispatch(system.parameters, [&](auto n) {
    constexpr int N = decltype(n)::value;
    result.topLeftCorner<N, N>() = informationMatrix<N>(system, mapped(scratch.weights));
    return 0;
  });
  return result;
}

}  // namespace radar_dot
