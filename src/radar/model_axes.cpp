// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "model_axes.h"

#include <Eigen/Dense>

namespace radar_dot {

ModelAxes axesOf(MotionModel model, bool turn_known) noexcept {
  ModelAxes axes{2, {0, 1}, 1};
  switch (model) {
    case MotionModel::kPlanar: break;
    case MotionModel::kPlanarYaw: axes = {3, {0, 1, 5}, 1}; break;
    case MotionModel::kAckermann: axes = {2, {0, 5}, 1}; break;
    case MotionModel::kSpatial: axes = {4, {0, 1, 2, 5}, 5}; break;
  }
  if (turn_known && axes.estimatesYawRate()) --axes.count;
  return axes;
}

Parameters likeliestMember(const ModelAxes& model, const ParameterMatrix& basis, int rank,
                           const Parameters& solution) {
  const int free = model.count - rank;
  if (free <= 0) return solution;
  constexpr double kLightWeight = 1e-4;
  Parameters weight = Parameters::Zero();
  for (int k = 0; k < model.count; ++k) {
    const int axis = model.axes[static_cast<std::size_t>(k)];
    weight[k] = axis == model.least || axis == 2 ? 1.0 : kLightWeight;
  }
  constexpr int kMost = ConstraintSystem::kMaxParameters;
  using Free = Eigen::Matrix<double, kMost, Eigen::Dynamic, 0, kMost, kMost>;
  const Free directions = basis.middleCols(rank, free);
  const Free weighted = weight.asDiagonal() * directions;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost> normal =
      directions.transpose() * weighted;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> gradient = weighted.transpose() * solution;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> step = normal.ldlt().solve(gradient);
  return solution - directions * step;
}

ParameterMatrix removeTrails(ParameterMatrix basis, int rank, int parameters) {
  constexpr double kTrace = 0.02;
  for (int i = 0; i < parameters; ++i) {
    auto free = basis.row(i).segment(rank, parameters - rank);
    if (free.norm() < kTrace) free.setZero();
  }
  return basis;
}

}  // namespace radar_dot
