// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "allocation_counter.h"
#include "radar_dot/radar/ego_velocity.h"
#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

TEST(Allocation, CounterSeesAllocations) {
  const std::size_t before = test::allocationCount();
  std::vector<int> values(1000);
  EXPECT_GT(test::allocationCount(), before) << values.size();
}

TEST(Allocation, ASteadyStreamOfSweepsDoesNotAllocate) {
  test::SweepOptions options;
  options.returns_per_radar = 88;
  options.moving_share = 0.2;
  options.doppler_sigma = 0.1;
  const test::Sweep sweep = test::makeSweep(test::carMounts(), {8.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, options);
  const std::vector<RadarScan> scans = sweep.scans();
  for (const MotionModel model :
       {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kAckermann, MotionModel::kSpatial}) {
    for (const Solver solver : {Solver::kLeastSquares, Solver::kRansac, Solver::kRansacRobust}) {
      EgoVelocityParams params;
      params.model = model;
      params.solver = solver;
      EgoVelocityEstimator estimator(params);
      EgoVelocityResult result;
      const auto estimate = [&] { estimator.estimate(scans, 0.0, Eigen::Vector3d::Zero(), result); };
      for (int i = 0; i < 3; ++i) estimate();
      const std::size_t before = test::allocationCount();
      for (int i = 0; i < 10; ++i) estimate();
      EXPECT_EQ(test::allocationCount(), before) << toString(model) << ' ' << toString(solver);
    }
  }
}

}  // namespace
}  // namespace radar_dot
