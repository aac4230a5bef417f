// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
// Networks for flow, and what surrounds those for depth. The flow networks are the TorchScript files in the
// environment variable RADAR_DOT_FLOW_MODELS, separated by colons.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "radar_dot/vision/just_depth.h"
#include "radar_dot/vision/optical_flow.h"

namespace {

namespace just_depth = radar_dot::just_depth;

/// A picture with something to see everywhere, moved by `shift` px.
cv::Mat texture(int width, int height, int shift) {
  cv::Mat noise(height / 4, width / 4 + 32, CV_8UC3), large;
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::resize(noise, large, {}, 4.0, 4.0, cv::INTER_CUBIC);
  return large(cv::Rect(64 - shift, 0, width, height)).clone();
}

void flow(benchmark::State& state, radar_dot::OpticalFlow& estimator) {
  const cv::Mat first = texture(1600, 900, 0);
  const cv::Mat second = texture(1600, 900, 6);
  for (auto _ : state) benchmark::DoNotOptimize(estimator.compute(first, second).flow.data);
}

void justDepthImage(benchmark::State& state) {
  const cv::Mat image = texture(1600, 900, 0);
  cv::Mat planes;
  for (auto _ : state) {
    just_depth::imagePlanes(image, planes);
    benchmark::DoNotOptimize(planes.data);
  }
}
BENCHMARK(justDepthImage)->Unit(benchmark::kMillisecond)->UseRealTime();

void justDepthRadar(benchmark::State& state) {
  const radar_dot::CameraIntrinsics camera{1260.0, 1260.0, 800.0, 450.0, 1600, 900};
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
  T_base_from_camera.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 125; ++i)
    points.emplace_back(5.0F + static_cast<float>(i), 0.3F * static_cast<float>(i % 40 - 20), 0.5F);
  for (auto _ : state)
    benchmark::DoNotOptimize(just_depth::radarColumns(points, camera, T_base_from_camera).data());
}
BENCHMARK(justDepthRadar)->Unit(benchmark::kMillisecond)->UseRealTime();

void justDepthOutput(benchmark::State& state) {
  const cv::Mat output(just_depth::kRows, just_depth::kWidth, CV_32FC1, cv::Scalar(20.0));
  for (auto _ : state) benchmark::DoNotOptimize(just_depth::onGrid(output, {800, 450}).data);
}
BENCHMARK(justDepthOutput)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The same pair for all, at their default sizes. @throws std::exception naming a file that is no network.
void registerFlows() {
  const auto add = [](const std::string& name, const radar_dot::OpticalFlowParams& params) {
    const std::shared_ptr<radar_dot::OpticalFlow> estimator = radar_dot::makeOpticalFlow(params);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [estimator](benchmark::State& state) { flow(state, *estimator); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  using radar_dot::FlowPreset;
  for (const FlowPreset preset : {FlowPreset::kMedium, FlowPreset::kFine}) {
    radar_dot::OpticalFlowParams params;
    params.preset = preset;
    add("flow/dis/" + std::string(toString(preset)), params);
  }
  const char* models = std::getenv("RADAR_DOT_FLOW_MODELS");
  if (models == nullptr) {
    benchmark::RegisterBenchmark("flow/torch", [](benchmark::State& state) {
      for (auto _ : state) state.SetLabel("skipped: RADAR_DOT_FLOW_MODELS is not set");
    });
    return;
  }
  std::istringstream files(models);
  for (std::string file; std::getline(files, file, ':');) {
    radar_dot::OpticalFlowParams params;
    params.backend = "torch";
    params.network.model = file;
    add("flow/torch/" + file.substr(file.find_last_of('/') + 1), params);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    registerFlows();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "torch_benchmark: RADAR_DOT_FLOW_MODELS: %s\n", error.what());
    return 1;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
