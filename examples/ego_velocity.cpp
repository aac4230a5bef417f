// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Returns of a radar in, velocity of the vehicle out.
#include <radar_dot/radar/one_scan.h>

#include <cstdio>

int main() {
  // What a radar 3.6 m ahead of the rear axle sees at 10 m/s in a left turn of 0.1 rad/s: the velocity of the
  // mount is (10, 0.36) m/s, and a static object comes nearer by its part along the line of sight.
  std::vector<radar_dot::DopplerReturn> returns;
  for (double azimuth = -1.0; azimuth < 1.0; azimuth += 0.05) {
    const double doppler = -(10.0 * std::cos(azimuth) + 3.6 * 0.1 * std::sin(azimuth));
    returns.push_back(radar_dot::polarReturn(30.0, azimuth, doppler));
  }
  // A car that comes towards it at 15 m/s.
  for (const double azimuth : {0.20, 0.21, 0.22})
    returns.push_back(radar_dot::polarReturn(40.0, azimuth, -25.0));

  const Eigen::Isometry3d mount(Eigen::Translation3d(3.6, 0.0, 0.5));
  const radar_dot::EgoVelocityResult motion = radar_dot::egoVelocityOf(returns, mount);
  if (!motion.valid()) {
    std::puts(motion.reason.c_str());
    return 1;
  }
  std::printf("vx %.2f m/s, yaw rate %.3f rad/s, %zu of %zu returns move\n", motion.linear.x(),
              motion.angular.z(), motion.dynamic_count, motion.return_count);
}
