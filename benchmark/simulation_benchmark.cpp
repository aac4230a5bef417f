// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "radar_dot/simulation/camera_sensor.h"
#include "radar_dot/simulation/lidar_sensor.h"
#include "radar_dot/simulation/scenario.h"
#include "simulation/sensors/ground_truth.h"
#include "simulation/sensors/radar_sensor.h"

namespace {

using namespace radar_dot::simulation;  // NOLINT: a program of its own

constexpr double kTime = 2.0;  // s

struct Stage {
  Scenario scenario = makeScenario("crossing", 20.0, 1);
  RayGeometry geometry{scenario.world};
  Snapshot now{scenario.world, geometry, kTime};
  PinholeCamera camera = cameraAt(cameraMounts().front(), *scenario.ego, kTime, kFullWidth, kFullHeight);
  VisibleSurfaces surfaces = traceSurfaces(now, camera);
};

const Stage& stage() {
  static const Stage stage;
  return stage;
}

std::size_t store(const char* extension, const cv::Mat& image, const std::vector<int>& options) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes, options);
  return bytes.size();
}

void buildScenario(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(makeScenario("crossing", 20.0, 1));
}

void buildGeometry(benchmark::State& state) {
  for (auto _ : state) RayGeometry geometry(stage().scenario.world);
}

void buildSnapshot(benchmark::State& state) {
  for (auto _ : state) Snapshot snapshot(stage().scenario.world, stage().geometry, kTime);
}

void tracePrimaryRays(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(traceSurfaces(stage().now, stage().camera));
}

void renderImage(benchmark::State& state) {
  const Stage& s = stage();
  for (auto _ : state)
    benchmark::DoNotOptimize(renderRadiance(s.scenario.world, s.now, s.camera, s.surfaces,
                                            s.scenario.ego->at(kTime).T_map_from_body));
}

void trueFlow(benchmark::State& state) {
  const Stage& s = stage();
  const Snapshot next(s.scenario.world, s.geometry, kTime + 1.0 / 12.0);
  const PinholeCamera next_camera =
      cameraAt(cameraMounts().front(), *s.scenario.ego, next.time(), kFullWidth, kFullHeight);
  for (auto _ : state) benchmark::DoNotOptimize(flowTruth(s.surfaces, s.now, s.camera, next, next_camera));
}

/// Everything a CAM_FRONT image at 1600x900 costs, files encoded.
void wholeFrame(benchmark::State& state) {
  const Stage& s = stage();
  const World& world = s.scenario.world;
  for (auto _ : state) {
    const Snapshot now(world, s.geometry, kTime);
    const Snapshot next(world, s.geometry, kTime + 1.0 / 12.0);
    const VisibleSurfaces surfaces = traceSurfaces(now, s.camera);
    const cv::Mat radiance =
        renderRadiance(world, now, s.camera, surfaces, s.scenario.ego->at(kTime).T_map_from_body);
    const PinholeCamera next_camera =
        cameraAt(cameraMounts().front(), *s.scenario.ego, next.time(), kFullWidth, kFullHeight);
    const FlowTruth flow = flowTruth(surfaces, now, s.camera, next, next_camera);
    const cv::Mat actors = actorTruth(surfaces, now);
    const std::vector<int> png = {cv::IMWRITE_PNG_COMPRESSION, 1};
    const std::vector<int> quick;
    store(".jpg", takePicture(radiance, world.lighting, {}, 1, 1), {cv::IMWRITE_JPEG_QUALITY, 90});
    store(".png", encodeDepth(depthTruth(surfaces, s.camera)), png);
    store(".png", encodeFlow(flow.flow), png);
    store(".png", flow.occlusion, quick);
    store(".png", actors, quick);
    store(".png", motionTruth(actors, world, kTime), quick);
  }
  state.SetItemsProcessed(state.iterations());
}

void lidarSweep(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(
        simulateLidarSweep(stage().now, lidarMount(), *stage().scenario.ego, LidarModel(), 1, 1));
}

void radarScan(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(
        simulateRadarScan(stage().now, radarMounts().front(), *stage().scenario.ego, 1, 1));
}

BENCHMARK(buildScenario)->Unit(benchmark::kMillisecond);
BENCHMARK(buildGeometry)->Unit(benchmark::kMillisecond);
BENCHMARK(buildSnapshot)->Unit(benchmark::kMillisecond);
BENCHMARK(tracePrimaryRays)->Unit(benchmark::kMillisecond);
BENCHMARK(renderImage)->Unit(benchmark::kMillisecond);
BENCHMARK(trueFlow)->Unit(benchmark::kMillisecond);
BENCHMARK(wholeFrame)->Unit(benchmark::kMillisecond);
BENCHMARK(lidarSweep)->Unit(benchmark::kMillisecond);
BENCHMARK(radarScan)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
