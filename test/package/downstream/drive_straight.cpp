// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The velocity of a vehicle that drives straight ahead at 10 m/s, from the returns of two radars.
#include <cmath>
#include <cstdio>
#include <vector>

#include "radar_dot/radar/sweep_estimator.h"

int main() {
  std::vector<std::vector<radar_dot::DopplerReturn>> returns(2);
  std::vector<radar_dot::RadarScan> scans(2);
  for (std::size_t radar = 0; radar < scans.size(); ++radar) {
    for (int degrees = -60; degrees <= 60; degrees += 2) {
      const double azimuth = degrees * M_PI / 180.0;
      radar_dot::DopplerReturn seen;
      seen.bearing = Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0).cast<float>();
      seen.range = 20.0F;
      seen.doppler =
          static_cast<float>((radar == 0 ? -10.0 : 10.0) * std::cos(azimuth));  // the rear one recedes
      returns[radar].push_back(seen);
    }
    scans[radar].returns = returns[radar];
    scans[radar].radar = radar;
  }
  scans[0].T_base_from_sensor = Eigen::Translation3d(3.5, 0.0, 0.5);
  scans[1].T_base_from_sensor =
      Eigen::Translation3d(-0.5, 0.0, 0.5) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());

  radar_dot::SweepEstimator estimator;
  const radar_dot::SweepEstimate estimate = estimator.estimate(scans, 0.0);
  std::printf("vx %.3f m/s\n", estimate.single.linear.x());
  return estimate.single.valid() && std::abs(estimate.single.linear.x() - 10.0) < 1e-3 ? 0 : 1;
}
