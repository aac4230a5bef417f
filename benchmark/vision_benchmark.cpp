// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "radar_dot/vision/motion_depth.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {
namespace {

/// A street: ground below, houses that come nearer to the sides, flow of a drive with the noise of a real
/// one.
MotionInput street() {
  MotionInput input;
  input.camera = {1266.0, 1266.0, 816.0, 491.0, 1600, 900};
  input.T_current_from_previous.translation() = Eigen::Vector3d(0.02, 0.0, -5.0);
  input.T_current_from_previous.linear() =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix();
  input.depth.create(900, 1600, CV_32FC1);
  for (int v = 0; v < 900; ++v) {
    for (int u = 0; u < 1600; ++u) {
      const double ground = v > 500 ? 1.5 * 1266.0 / (v - 491.0) : 100.0;
      const double house = 8.0 * 1266.0 / (1.0 + std::abs(u - 816.0));
      input.depth.at<float>(v, u) = static_cast<float>(std::min({ground, house, 100.0}));
    }
  }
  cv::subtract(input.depth, 5.0, input.next_depth);
  input.next_depth = cv::max(input.next_depth, 1.0);
  input.flow = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  input.flow_valid = cv::Mat(input.depth.size(), CV_8UC1, cv::Scalar(255));
  std::mt19937 random(1);
  for (int v = 0; v < 900; ++v) {
    for (int u = 0; u < 1600; ++u) {
      const auto noise = static_cast<float>(static_cast<double>(random()) / 4294967296.0 - 0.5);
      input.flow.at<cv::Vec2f>(v, u) += cv::Vec2f(noise, -noise);
    }
  }
  return input;
}

/// Something a tenth as wide as the image, whose flow no error of depth explains: above hysteresis_ratio
/// times the threshold.
void addMover(MotionInput& input) {
  for (int v = 480; v < 560; ++v)
    for (int u = 300; u < 460; ++u) input.flow.at<cv::Vec2f>(v, u) += cv::Vec2f(0.0F, 160.0F);
}

void motionSegmenter(benchmark::State& state) {
  MotionInput input = street();
  addMover(input);
  const auto threads = static_cast<std::size_t>(state.range(0));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  cv::setNumThreads(static_cast<int>(threads));
  MotionSegmenter segmenter;
  for (auto _ : state) benchmark::DoNotOptimize(segmenter.segment(input).threshold);
}
BENCHMARK(motionSegmenter)->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();

/// With everything the score by uncertainty looks at: a gap for every pixel, a relative depth noise for every
/// pixel, and the covariance of the motion.
void motionSegmenterByUncertainty(benchmark::State& state) {
  MotionInput input = street();
  addMover(input);
  input.flow_valid.release();
  input.fb_error = cv::Mat(input.depth.size(), CV_32FC1, cv::Scalar(0.5));
  input.depth_std = cv::Mat(input.depth.size(), CV_32FC1, cv::Scalar(0.2));
  input.motion_covariance.diagonal() << 1e-4, 1e-5, 1e-4, 1e-3, 1e-3, 2e-3;
  const auto threads = static_cast<std::size_t>(state.range(0));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  cv::setNumThreads(static_cast<int>(threads));
  MotionParams params;
  params.score = MotionScore::kUncertainty;
  MotionSegmenter segmenter(params);
  for (auto _ : state) benchmark::DoNotOptimize(segmenter.segment(input).threshold);
  if (cv::countNonZero(segmenter.segment(input).mask) < 10000) state.SkipWithError("the car is not found");
}
BENCHMARK(motionSegmenterByUncertainty)
    ->Arg(1)
    ->Arg(2)
    ->ArgName("threads")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// A street at 12 Hz on the grid of masks: carried, refined and measured at every pixel.
void motionDepth(benchmark::State& state) {
  MotionInput drive = street();
  const cv::Size grid(640, 360);
  MotionDepthInput input;
  input.camera = drive.camera.scaledTo(grid.width, grid.height);
  input.pixel_scale = 2.5;
  cv::resize(drive.depth, input.prior_depth, grid, 0.0, 0.0, cv::INTER_NEAREST);
  input.farthest = 1.3 * input.prior_depth;
  input.prior_std = cv::Mat(grid, CV_32FC1, cv::Scalar(0.3));
  MotionDepthInput::Step step;
  step.T_current_from_previous.translation() = Eigen::Vector3d(0.02, 0.0, -0.8);
  step.motion_covariance.diagonal() << 1e-5, 1e-5, 1e-5, 1e-4, 1e-4, 1e-4;
  step.flow_back = expectedFlow(input.camera, step.T_current_from_previous.inverse(), input.prior_depth);
  step.fb_error = cv::Mat(grid, CV_32FC1, cv::Scalar(0.2));
  input.prior_depth *= 1.2;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
  MotionDepth filter;
  bool measured = false;
  for (auto _ : state) {
    step.previous_time = input.time;
    if (input.time > 0.0) input.step = step;
    input.time += 0.08;
    measured = filter.update(input).measured;
    benchmark::DoNotOptimize(measured);
  }
  if (state.iterations() > 1 && !measured) state.SkipWithError("no depth is measured");
}
BENCHMARK(motionDepth)->Arg(1)->Arg(2)->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace radar_dot

BENCHMARK_MAIN();
