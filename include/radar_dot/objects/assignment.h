// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace radar_dot {

/// Stands for the column of a row without a partner.
inline constexpr int kUnassigned = -1;

/// Partners of least total cost, one-to-one: a pair costs costs(row, column), a row without a partner costs
/// `unassigned_cost`, so that no pair above it is made. Entries that are not finite are forbidden.
/// The Hungarian method with potentials in O(rows^2 (rows + columns)).
/// Kuhn: The Hungarian method for the assignment problem, Naval Research Logistics 2, 1955.
/// @return for each row its column, or kUnassigned
std::vector<int> assign(const Eigen::MatrixXd& costs, double unassigned_cost);

}  // namespace radar_dot
