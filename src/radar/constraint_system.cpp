// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "constraint_system.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace radar_dot {
namespace {

/// splitmix64: small, fast, and the same numbers on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// Uniform in [0, bound), bound < 2^32.
  std::size_t below(std::size_t bound) {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    return static_cast<std::size_t>(((z >> 32) * bound) >> 32);
  }

 private:
  std::uint64_t state_;
};

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

/// Calls `body` with the number of parameters as a compile-time constant.
template <typename Body>
auto dispatch(int parameters, Body&& body) {
  switch (parameters) {
    case 1: return body(std::integral_constant<int, 1>{});
    case 2: return body(std::integral_constant<int, 2>{});
    default: return body(std::integral_constant<int, 3>{});
  }
}

/// A X - b as a lazy expression over all rows, in single precision.
template <int N>
auto residualExpression(const ConstraintSystem& system, const Parameters& x) {
  const Eigen::Vector3f f = x.cast<float>();
  if constexpr (N == 1) {
    return system.column(0) * f[0] - system.rightHandSide();
  } else if constexpr (N == 2) {
    return system.column(0) * f[0] + system.column(1) * f[1] - system.rightHandSide();
  } else {
    return system.column(0) * f[0] + system.column(1) * f[1] + system.column(2) * f[2] - system.rightHandSide();
  }
}

template <int N>
Vector<N> row(const ConstraintSystem& system, std::size_t i) {
  Vector<N> result;
  for (int k = 0; k < N; ++k) result[k] = static_cast<double>(system.columns[static_cast<std::size_t>(k)][i]);
  return result;
}

/// Accumulates weight(i) * a a' and weight(i) * a b; rows of weight 0 are skipped.
template <int N, typename Weight>
void accumulate(const ConstraintSystem& system, Weight&& weight, Matrix<N>& information, Vector<N>& rhs) {
  information.setZero();
  rhs.setZero();
  for (std::size_t i = 0; i < system.rows; ++i) {
    const double w = weight(i);
    if (w <= 0.0) continue;
    const Vector<N> a = row<N>(system, i);
    const Vector<N> wa = w * a;
    information.noalias() += wa * a.transpose();
    rhs.noalias() += wa * static_cast<double>(system.right_hand_side[i]);
  }
}

template <int N>
bool solveNormal(const Matrix<N>& information, const Vector<N>& rhs, Parameters& solution) {
  const Eigen::LDLT<Matrix<N>> factors(information);
  const Vector<N> diagonal = factors.vectorD();
  if (factors.info() != Eigen::Success || !(diagonal.minCoeff() > 1e-12 * std::max(diagonal.maxCoeff(), 1e-12))) {
    return false;
  }
  solution.setZero();
  solution.template head<N>() = factors.solve(rhs);
  return solution.allFinite();
}

template <int N, typename Weight>
bool solveWeighted(const ConstraintSystem& system, Weight&& weight, Parameters& solution) {
  Matrix<N> information;
  Vector<N> rhs;
  accumulate<N>(system, weight, information, rhs);
  return solveNormal<N>(information, rhs, solution);
}

/// Solves N rows exactly; false for samples so close to parallel that they amplify noise.
template <int N>
bool solveMinimal(const Matrix<N>& a, const Vector<N>& b, Parameters& solution) {
  double determinant = 0.0;
  bool invertible = false;
  Matrix<N> inverse;
  a.computeInverseAndDetWithCheck(inverse, determinant, invertible, 1e-3);
  if (!invertible) return false;
  solution.setZero();
  solution.template head<N>() = inverse * b;
  return true;
}

/// Draws N different rows.
template <int N>
std::array<std::size_t, N> drawSample(Random& random, std::size_t rows) {
  std::array<std::size_t, N> sample{};
  for (int k = 0; k < N; ++k) {
    bool repeated = true;
    while (repeated) {
      sample[static_cast<std::size_t>(k)] = random.below(rows);
      repeated = std::find(sample.begin(), sample.begin() + k, sample[static_cast<std::size_t>(k)]) !=
                 sample.begin() + k;
    }
  }
  return sample;
}

template <int N>
bool ransac(const ConstraintSystem& system, const RansacParams& params, Parameters& best,
            std::vector<float>& residuals) {
  if (system.rows < static_cast<std::size_t>(N)) return false;
  Random random(params.seed);
  const float truncation = static_cast<float>(params.inlier_threshold * params.inlier_threshold);
  const auto cost = [&](const Parameters& x) {
    return residualExpression<N>(system, x).square().min(truncation).sum();
  };
  float best_cost = std::numeric_limits<float>::infinity();
  for (int iteration = 0; iteration < params.iterations; ++iteration) {
    const auto sample = drawSample<N>(random, system.rows);
    Matrix<N> a;
    Vector<N> b;
    for (int k = 0; k < N; ++k) {
      const std::size_t i = sample[static_cast<std::size_t>(k)];
      a.row(k) = row<N>(system, i).transpose();
      b[k] = static_cast<double>(system.right_hand_side[i]);
    }
    Parameters hypothesis;
    if (!solveMinimal<N>(a, b, hypothesis)) continue;
    const float hypothesis_cost = cost(hypothesis);
    if (!(hypothesis_cost < best_cost)) continue;
    best_cost = hypothesis_cost;
    best = hypothesis;
    evaluateResiduals(system, hypothesis, residuals);
    Parameters polished;
    if (!solveInliers(system, residuals, params.inlier_threshold, polished)) continue;
    const float polished_cost = cost(polished);
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
  sigma.resize(row_count);
}

void evaluateResiduals(const ConstraintSystem& system, const Parameters& solution, std::vector<float>& residuals) {
  residuals.resize(system.rows);
  Eigen::Map<Eigen::ArrayXf> out(residuals.data(), static_cast<Eigen::Index>(system.rows));
  dispatch(system.parameters, [&](auto n) {
    out = residualExpression<decltype(n)::value>(system, solution);
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
    Vector<N> unused;
    accumulate<N>(system, [](std::size_t) { return 1.0; }, information, unused);
    const Eigen::SelfAdjointEigenSolver<Matrix<N>> eigen(information);
    const Vector<N> values = eigen.eigenvalues().cwiseMax(0.0);  // ascending
    const double largest = values[N - 1];
    const double floor = largest / (max_condition_number * max_condition_number);
    for (int k = 0; k < N; ++k) {
      if (largest > 0.0 && values[k] >= floor) ++result.rank;
    }
    if (values[0] > 0.0) result.condition_number = std::sqrt(largest / values[0]);
    if (result.rank < N) {
      result.condition_number = std::numeric_limits<double>::infinity();
      for (int k = 0; k < N; ++k) {  // constrained directions first
        result.basis.template block<N, 1>(0, k) = eigen.eigenvectors().col(N - 1 - k);
      }
    }
    return 0;
  });
  return result;
}

void projectSystem(const ConstraintSystem& system, const Observability& observability, ConstraintSystem& projected) {
  projected.resize(observability.rank, system.rows);
  const auto rows = static_cast<Eigen::Index>(system.rows);
  for (int k = 0; k < observability.rank; ++k) {
    Eigen::Map<Eigen::ArrayXf> out(projected.columns[static_cast<std::size_t>(k)].data(), rows);
    out.setZero();
    for (int j = 0; j < system.parameters; ++j) {
      out += system.column(j) * static_cast<float>(observability.basis(j, k));
    }
  }
  std::copy_n(system.right_hand_side.begin(), system.rows, projected.right_hand_side.begin());
  std::copy_n(system.sigma.begin(), system.rows, projected.sigma.begin());
}

bool solveLeastSquares(const ConstraintSystem& system, Parameters& solution) {
  return dispatch(system.parameters, [&](auto n) {
    return solveWeighted<decltype(n)::value>(system, [](std::size_t) { return 1.0; }, solution);
  });
}

bool solveInliers(const ConstraintSystem& system, const std::vector<float>& residuals, double threshold,
                  Parameters& solution) {
  const float limit = static_cast<float>(threshold);
  return dispatch(system.parameters, [&](auto n) {
    return solveWeighted<decltype(n)::value>(
        system, [&](std::size_t i) { return std::abs(residuals[i]) < limit ? 1.0 : 0.0; }, solution);
  });
}

bool solveRansac(const ConstraintSystem& system, const RansacParams& params, Parameters& solution,
                 std::vector<float>& residuals) {
  return dispatch(system.parameters,
                  [&](auto n) { return ransac<decltype(n)::value>(system, params, solution, residuals); });
}

bool refineRobust(const ConstraintSystem& system, int iterations, Parameters& solution,
                  std::vector<float>& residuals) {
  return dispatch(system.parameters, [&](auto n) {
    constexpr int N = decltype(n)::value;
    constexpr double kConverged = 1e-5;  // m/s: far below what the data can tell
    for (int iteration = 0; iteration < iterations; ++iteration) {
      evaluateResiduals(system, solution, residuals);
      const Parameters before = solution;
      const auto weight = [&](std::size_t i) {
        const double sigma = static_cast<double>(system.sigma[i]);
        const double e = static_cast<double>(residuals[i]);
        return 1.0 / (sigma * sigma + e * e);  // Cauchy: (1 / sigma^2) / (1 + (e / sigma)^2)
      };
      if (!solveWeighted<N>(system, weight, solution)) {
        solution = before;
        return iteration > 0;
      }
      if ((solution - before).cwiseAbs().maxCoeff() < kConverged) break;
    }
    return true;
  });
}

NormalEquations inlierInformation(const ConstraintSystem& system, const std::vector<float>& residuals,
                                  double threshold) {
  NormalEquations result;
  const float limit = static_cast<float>(threshold);
  dispatch(system.parameters, [&](auto n) {
    constexpr int N = decltype(n)::value;
    Matrix<N> information;
    Vector<N> rhs;
    accumulate<N>(
        system,
        [&](std::size_t i) {
          const double sigma = static_cast<double>(system.sigma[i]);
          return std::abs(residuals[i]) < limit ? 1.0 / (sigma * sigma) : 0.0;
        },
        information, rhs);
    result.information.template topLeftCorner<N, N>() = information;
    result.right_hand_side.template head<N>() = rhs;
    return 0;
  });
  return result;
}

}  // namespace radar_dot
