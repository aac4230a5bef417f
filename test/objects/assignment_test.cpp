// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

namespace radar_dot {
namespace {

using Partners = std::vector<int>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double costOf(const Eigen::MatrixXd& costs, const Partners& partners, double unassigned_cost) {
  double total = 0.0;
  for (std::size_t row = 0; row < partners.size(); ++row)
    total +=
        partners[row] == kUnassigned ? unassigned_cost : costs(static_cast<Eigen::Index>(row), partners[row]);
  return total;
}

/// Least total cost by trying everything.
double leastCost(const Eigen::MatrixXd& costs, double unassigned_cost) {
  std::vector<int> columns(static_cast<std::size_t>(costs.rows() + costs.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double least = kInfinity;
  do {
    Partners partners(static_cast<std::size_t>(costs.rows()), kUnassigned);
    for (std::size_t row = 0; row < partners.size(); ++row)
      if (columns[row] < costs.cols()) partners[row] = columns[row];
    least = std::min(least, costOf(costs, partners, unassigned_cost));
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(Assignment, TheNearestPairIsNotTakenWhenItCostsTheOthersMore) {
  Eigen::MatrixXd costs(2, 2);
  costs << 1.0, 2.0, 1.5, 10.0;
  EXPECT_EQ(assign(costs, 100.0), (Partners{1, 0}));
}

TEST(Assignment, NobodyPairsAboveTheCostOfNoPartner) {
  Eigen::MatrixXd costs(2, 2);
  costs << 1.0, 2.0, 1.5, 10.0;
  EXPECT_EQ(assign(costs, 1.2), (Partners{0, kUnassigned}));
  EXPECT_EQ(assign(costs, 0.5), (Partners{kUnassigned, kUnassigned}));
}

TEST(Assignment, ForbiddenPairsAndEmptySides) {
  Eigen::MatrixXd costs(2, 1);
  costs << kInfinity, 3.0;
  EXPECT_EQ(assign(costs, 100.0), (Partners{kUnassigned, 0}));
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0), 1.0), (Partners{kUnassigned, kUnassigned}));
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3), 1.0).empty());
}

// Costs may be negative, as those of d^2 + ln det S.
TEST(Assignment, IsTheBestOfAll) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> cost(-3.0, 10.0);
  for (int trial = 0; trial < 60; ++trial) {
    Eigen::MatrixXd costs(1 + trial % 3, 1 + trial / 3 % 4);
    for (Eigen::Index i = 0; i < costs.size(); ++i) costs(i) = cost(random) > 8.0 ? kInfinity : cost(random);
    const Partners partners = assign(costs, 6.0);
    EXPECT_NEAR(costOf(costs, partners, 6.0), leastCost(costs, 6.0), 1e-9);
    std::vector<int> taken;
    for (const int column : partners)
      if (column != kUnassigned) taken.push_back(column);
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(std::adjacent_find(taken.begin(), taken.end()), taken.end());
  }
}

}  // namespace
}  // namespace radar_dot
