// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/assignment.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace radar_dot {
namespace {

/// Shortest augmenting paths over a matrix with a private column for every row: that of no partner.
class HungarianMethod {
 public:
  HungarianMethod(const Eigen::MatrixXd& costs, double unassigned_cost)
      : costs_(costs),
        unassigned_cost_(unassigned_cost),
        columns_(costs.cols() + costs.rows()),
        row_potential_(Eigen::VectorXd::Zero(costs.rows())),
        column_potential_(Eigen::VectorXd::Zero(columns_)),
        row_of_column_(static_cast<std::size_t>(columns_), kUnassigned) {}

  std::vector<int> solve() {
    for (Eigen::Index row = 0; row < costs_.rows(); ++row) augment(static_cast<int>(row));
    std::vector<int> column_of_row(static_cast<std::size_t>(costs_.rows()), kUnassigned);
    for (Eigen::Index column = 0; column < costs_.cols(); ++column) {
      const int row = rowOf(column);
      if (row != kUnassigned) column_of_row[static_cast<std::size_t>(row)] = static_cast<int>(column);
    }
    return column_of_row;
  }

 private:
  int& rowOf(Eigen::Index column) { return row_of_column_[static_cast<std::size_t>(column)]; }

  double cost(int row, Eigen::Index column) const {
    if (column >= costs_.cols()) return unassigned_cost_;
    const double value = costs_(row, column);
    // Above the cost of no partner a pair is never better than none.
    return std::isfinite(value) && value <= unassigned_cost_ ? value
                                                             : std::numeric_limits<double>::infinity();
  }
  bool allowed(int row, Eigen::Index column) const {
    return column < costs_.cols() || column == costs_.cols() + row;
  }

  void augment(int first_row) {
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(columns_, std::numeric_limits<double>::infinity());
    std::vector<Eigen::Index> came_from(static_cast<std::size_t>(columns_), -1);
    std::vector<bool> done(static_cast<std::size_t>(columns_), false);
    int row = first_row;
    Eigen::Index current = -1;
    while (true) {
      const double reached = current < 0 ? 0.0 : distance(current);
      for (Eigen::Index column = 0; column < columns_; ++column) {
        if (done[static_cast<std::size_t>(column)] || !allowed(row, column)) continue;
        const double path = reached + cost(row, column) - row_potential_(row) - column_potential_(column);
        if (path >= distance(column)) continue;
        distance(column) = path;
        came_from[static_cast<std::size_t>(column)] = current;
      }
      Eigen::Index nearest = -1;
      for (Eigen::Index column = 0; column < columns_; ++column) {
        if (done[static_cast<std::size_t>(column)] || !std::isfinite(distance(column))) continue;
        if (nearest < 0 || distance(column) < distance(nearest)) nearest = column;
      }
      current = nearest;  // exists: the column of no partner is always within reach
      if (rowOf(current) == kUnassigned) break;
      done[static_cast<std::size_t>(current)] = true;
      row = rowOf(current);
    }
    const double shortest = distance(current);
    row_potential_(first_row) += shortest;
    for (Eigen::Index column = 0; column < columns_; ++column) {
      if (!done[static_cast<std::size_t>(column)]) continue;
      row_potential_(rowOf(column)) += shortest - distance(column);
      column_potential_(column) -= shortest - distance(column);
    }
    while (current >= 0) {
      const Eigen::Index before = came_from[static_cast<std::size_t>(current)];
      rowOf(current) = before < 0 ? first_row : rowOf(before);
      current = before;
    }
  }

  const Eigen::MatrixXd& costs_;
  double unassigned_cost_;
  Eigen::Index columns_;
  Eigen::VectorXd row_potential_, column_potential_;
  std::vector<int> row_of_column_;
};

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& costs, double unassigned_cost) {
  return HungarianMethod(costs, unassigned_cost).solve();
}

}  // namespace radar_dot
