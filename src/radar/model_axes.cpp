// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "model_axes.h"

#include <Eigen/Dense>
#include <cmath>

namespace radar_dot {

ModelAxes axesOf(MotionModel model) noexcept {
  switch (model) {
    case MotionModel::kPlanar: return {2, {0, 1, 0}};
    case MotionModel::kPlanarYaw: return {3, {0, 1, 5}};
    case MotionModel::kAckermann: return {2, {0, 5, 0}};
    case MotionModel::kSpatial: return {3, {0, 1, 2}};
  }
  return {2, {0, 1, 0}};
}

Parameters leastSideslipMember(const ModelAxes& model, const Eigen::Matrix3d& basis, int rank,
                           const Parameters& solution) {
  const int free = model.count - rank;
  if (free <= 0) return solution;
  constexpr double kLightWeight = 1e-4;
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  for (int k = 0; k < model.count; ++k) {
    const int axis = model.axes[static_cast<std::size_t>(k)];
    weight[k] = axis == 1 || axis == 2 ? 1.0 : kLightWeight;
  }
  using Free = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2>;
  const Free directions = basis.middleCols(rank, free);
  const Free weighted = weight.asDiagonal() * directions;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2> normal =
      directions.transpose() * weighted;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> gradient = weighted.transpose() * solution;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2, 1> step = normal.ldlt().solve(gradient);
  return solution - directions * step;
}

Eigen::Matrix3d removeTrails(Eigen::Matrix3d basis, int rank, int parameters) {
  constexpr double kTrace = 0.02;
  for (int k = rank; k < parameters; ++k) {
    for (int i = 0; i < parameters; ++i) {
      if (std::abs(basis(i, k)) < kTrace) basis(i, k) = 0.0;
    }
  }
  return basis;
}

}  // namespace radar_dot
