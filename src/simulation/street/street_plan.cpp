// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/street/street_plan.h"

#include <algorithm>
#include <cmath>

namespace radar_dot::simulation {

std::vector<Street::Gap> Street::free(double low, double high, std::vector<Gap> gaps) {
  std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.low < b.low; });
  std::vector<Gap> stretches;
  double begin = low;
  for (const Gap& gap : gaps) {
    if (std::min(gap.low, high) > begin) stretches.push_back({begin, std::min(gap.low, high)});
    begin = std::max(begin, gap.high);
  }
  if (high > begin) stretches.push_back({begin, high});
  return stretches;
}

std::size_t StreetPlan::cross(std::size_t main, double on_main, const Street& street, double on_cross,
                              bool signals) {
  const std::size_t number = streets.size();
  streets.push_back(street);
  Street& first = streets[main];
  Street& second = streets[number];
  second.priority = false;
  second.T_map_from_street = first.T_map_from_street * Eigen::Translation3d(on_main, 0.0, 0.0) *
                             Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitZ()) *
                             Eigen::Translation3d(-on_cross, 0.0, 0.0);
  const double first_half = first.profile.halfRoad();
  const double second_half = second.profile.halfRoad();
  const auto open = [&](Street& one, double at, double other_half) {
    const double reach = other_half + kPavementWidth;
    one.junctions.push_back({at - reach, at + reach});
    one.kept_clear.push_back({at - reach - 9.0, at + reach + 9.0});
    if (!signals) return;
    for (const double side : {-1.0, 1.0}) one.zebras.push_back(at + side * zebraDistance(other_half));
  };
  open(first, on_main, second_half);
  open(second, on_cross, first_half);
  junctions.push_back({main, number, on_main, on_cross, signals});
  return number;
}

double StreetPlan::groundHeight(const Eigen::Vector2d& place) const {
  for (const Street& street : streets) {
    const Eigen::Vector3d local =
        street.T_map_from_street.linear().transpose() *
        (Eigen::Vector3d(place.x(), place.y(), 0.0) - street.T_map_from_street.translation());
    if (local.x() >= 0.0 && local.x() <= street.length && std::abs(local.y()) <= street.profile.halfRoad())
      return 0.0;
  }
  for (const Junction& junction : junctions) {
    const Street& main = streets[junction.main];
    const Eigen::Vector3d local =
        main.T_map_from_street.inverse() * Eigen::Vector3d(place.x(), place.y(), 0.0);
    const double x =
        std::abs(local.x() - junction.on_main) - streets[junction.cross].profile.halfRoad() - kPavementWidth;
    const double y = std::abs(local.y()) - main.profile.halfRoad() - kPavementWidth;
    if (x < 0.0 && y < 0.0 && std::hypot(x, y) > kPavementWidth) return 0.0;
  }
  return kKerbHeight;
}

}  // namespace radar_dot::simulation
