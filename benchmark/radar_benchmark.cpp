// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cstring>

#include "radar/allocation_counter.h"
#include "radar/synthetic_sweep.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/radar_agreement.h"
#include "radar_dot/radar/sweep_estimator.h"

namespace {

using namespace radar_dot;

// A five-radar sweep as nuScenes gives it: 440 returns, a fifth of them moving.
test::Sweep makeNuscenesLikeSweep() {
  test::SweepOptions options;
  options.returns_per_radar = 88;
  options.moving_share = 0.2;
  options.doppler_sigma = 0.12;
  return test::makeSweep(test::carMounts(), {8.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, options);
}

void sweep(benchmark::State& state, MotionModel model, Solver solver) {
  const test::Sweep data = makeNuscenesLikeSweep();
  const std::vector<RadarScan> scans = data.scans();
  EgoVelocityParams params;
  params.model = model;
  params.solver = solver;
  EgoVelocityEstimator estimator(params);
  EgoVelocityResult result;
  const auto estimate = [&] { estimator.estimate(scans, 0.0, Eigen::Vector3d::Zero(), result); };
  for (int i = 0; i < 3; ++i) estimate();  // its buffers grow to their size
  const std::size_t before = test::allocationCount();
  estimate();
  state.counters["allocations"] = static_cast<double>(test::allocationCount() - before);
  for (auto _ : state) {
    estimate();
    benchmark::DoNotOptimize(result.linear);
  }
  state.counters["returns"] = static_cast<double>(data.returns.size() * data.returns[0].size());
}
BENCHMARK_CAPTURE(sweep, planar_ransac_robust, MotionModel::kPlanar, Solver::kRansacRobust);
BENCHMARK_CAPTURE(sweep, planar_yaw_ransac_robust, MotionModel::kPlanarYaw, Solver::kRansacRobust);
BENCHMARK_CAPTURE(sweep, ackermann_ransac_robust, MotionModel::kAckermann, Solver::kRansacRobust);
BENCHMARK_CAPTURE(sweep, spatial_ransac_robust, MotionModel::kSpatial, Solver::kRansacRobust);
BENCHMARK_CAPTURE(sweep, planar_yaw_ransac, MotionModel::kPlanarYaw, Solver::kRansac);
BENCHMARK_CAPTURE(sweep, planar_least_squares, MotionModel::kPlanar, Solver::kLeastSquares);

// One imaging radar with 9000 returns, a fifth of them moving, in all that the nodelet does with a sweep.
void imaging(benchmark::State& state, MotionModel model) {
  test::SweepOptions options;
  options.returns_per_radar = 9000;
  options.moving_share = 0.2;
  options.doppler_sigma = 0.12;
  options.max_elevation = 0.3;
  const test::Sweep data =
      test::makeSweep({test::mount(3.5, 0.0, 0.7, 0.0)}, {8.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, options);
  std::vector<RadarScan> scans = data.scans();
  SweepEstimatorParams params;
  params.estimator.model = model;
  SweepEstimator estimator(params);
  double time = 0.0;
  for (auto _ : state) {
    scans[0].time = time += 1.0 / 15.0;
    benchmark::DoNotOptimize(estimator.estimate(scans, time));
  }
}
BENCHMARK_CAPTURE(imaging, ackermann, MotionModel::kAckermann)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(imaging, spatial, MotionModel::kSpatial)->Unit(benchmark::kMillisecond);

// Beside the estimate, at 13 sweeps a second of which some are looked at.
void agreement(benchmark::State& state) {
  const test::Sweep data = makeNuscenesLikeSweep();
  const std::vector<RadarScan> scans = data.scans();
  EgoVelocityEstimator estimator;
  const EgoVelocityResult result = estimator.estimate(scans, 0.0);
  RadarAgreement agreement({{"front"}, {"left"}, {"right"}, {"rear_left"}, {"rear_right"}});
  double time = 0.0;
  for (auto _ : state) agreement.add(time += 0.075, scans, result, estimator.params());
}
BENCHMARK(agreement);

// A scan of 88 records with 18 fields, as in a nuScenes file.
void extract(benchmark::State& state) {
  PointCloud cloud;
  for (const char* name : {"x", "y", "z", "rcs", "vx", "vy"}) {
    cloud.fields.push_back({name, static_cast<std::uint32_t>(cloud.point_step), ScalarType::kFloat32, 1});
    cloud.point_step += 4;
  }
  for (const char* name : {"invalid_state", "ambig_state", "pdh0"}) {
    cloud.fields.push_back({name, static_cast<std::uint32_t>(cloud.point_step), ScalarType::kInt8, 1});
    cloud.point_step += 1;
  }
  cloud.size = 88;
  cloud.data.assign(cloud.point_step * cloud.size, 0);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    std::uint8_t* point = cloud.data.data() + i * cloud.point_step;
    const float values[] = {10.F + static_cast<float>(i), 5.F, 0.F, 3.F, -8.F, 0.5F};
    std::memcpy(point, values, sizeof values);
    point[cloud.point_step - 2] = 3;
    point[cloud.point_step - 1] = 1;
  }
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(cloud.view(), returns).accepted);
}
BENCHMARK(extract);

// A scan of 9400 records with 7 fields, as of an Oculii Eagle, with all limits in use.
void extractLarge(benchmark::State& state) {
  PointCloud cloud;
  for (const char* name : {"x", "y", "z", "doppler", "power", "recoveredSpeed", "denoiseFlag"}) {
    cloud.fields.push_back({name, static_cast<std::uint32_t>(cloud.point_step), ScalarType::kFloat32, 1});
    cloud.point_step += 4;
  }
  cloud.size = 9400;
  std::vector<float> values;
  for (std::size_t i = 0; i < cloud.size; ++i)
    values.insert(values.end(), {10.F, static_cast<float>(i % 20), 0.5F, -5.F, 12.F, 0.F, 0.F});
  cloud.data.resize(cloud.point_step * cloud.size);
  std::memcpy(cloud.data.data(), values.data(), cloud.data.size());
  ExtractionParams params;
  params.filter.max_azimuth = params.filter.max_elevation = 1.2;
  params.filter.min_height = -1.0;
  params.filter.min_snr = 10.0;
  params.filter.flag_field = "denoiseFlag";
  params.filter.accepted_flags = {0, 1};
  DopplerExtractor extractor(params);
  const Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  std::vector<DopplerReturn> returns;
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(cloud.view(), returns, &mount).accepted);
}
BENCHMARK(extractLarge);

}  // namespace

BENCHMARK_MAIN();
