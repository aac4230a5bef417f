// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What an image costs from the bytes of its JPEG to the mask, with the values of config/masks.yaml.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "fixtures/camera_mount.h"
#include "nodelets/messages/lazy_image.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/mask_pipeline.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

constexpr double kInterval = 1.0 / 12.0;  // s
constexpr int kWorkingWidth = 640;        // px
const CameraIntrinsics kCamera{1266.0, 1266.0, 816.0, 491.0, 1600, 900};
const cv::Rect kMover(300, 480, 160, 80);  // px, a tenth as wide as the image

/// What the camera sees at 10 m/s, and how it came to see it.
struct Street {
  Eigen::Isometry3d T_base_from_camera = test::lookingAhead({1.7, 0.0, 1.5});
  Eigen::Isometry3d T_first_from_second = Eigen::Isometry3d(Eigen::Translation3d(10.0 * kInterval, 0.0, 0.0));
  std::vector<Eigen::Vector3f> returns;
  sensor_msgs::CompressedImageConstPtr first, second;

  Street();
  DepthInput depthInput(const CameraIntrinsics& camera) const {
    DepthInput input;
    input.camera = camera;
    input.T_base_from_camera = T_base_from_camera;
    input.radar_points = returns;
    return input;
  }
};

cv::Mat texture(const cv::Size& size) {
  cv::Mat sum(size, CV_32FC3, cv::Scalar());
  cv::RNG random(7);
  for (const int cell : {4, 16, 64}) {
    cv::Mat nodes(size.height / cell + 2, size.width / cell + 2, CV_32FC3), layer;
    random.fill(nodes, cv::RNG::UNIFORM, 0.0, 80.0);
    cv::resize(nodes, layer, size, 0.0, 0.0, cv::INTER_CUBIC);
    sum += layer;
  }
  sum.convertTo(sum, CV_8U);
  return sum;
}

sensor_msgs::CompressedImageConstPtr jpegOf(const cv::Mat& picture) {
  auto message = boost::make_shared<sensor_msgs::CompressedImage>();
  message->format = "bgr8; jpeg compressed bgr8";
  cv::imencode(".jpg", picture, message->data, {cv::IMWRITE_JPEG_QUALITY, 90});
  return message;
}

Street::Street() {
  for (int i = 0; i < 100; ++i)
    returns.emplace_back(5.0F + static_cast<float>(i), 20.0F * std::sin(static_cast<float>(i)), 0.5F);
  const cv::Size size(kCamera.width, kCamera.height);
  cv::Mat to = expectedFlow(kCamera, staticPointMotion(T_base_from_camera, T_first_from_second),
                            makeDepthEstimator({})->estimate(depthInput(kCamera)));
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      auto& target = to.at<cv::Vec2f>(v, u);
      if (!(std::abs(target[0]) < 100.0F && std::abs(target[1]) < 100.0F)) target = {};
      if (kMover.contains({u, v})) target += cv::Vec2f(0.0F, 25.0F);
      target += cv::Vec2f(static_cast<float>(u), static_cast<float>(v));
    }
  }
  const cv::Mat now = texture(size);
  cv::Mat before;
  cv::remap(now, before, to, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  first = jpegOf(before);
  second = jpegOf(now);
}

OpticalFlowParams flowParams(bool forward_backward) {
  OpticalFlowParams params;
  params.working_width = kWorkingWidth;
  params.preset = FlowPreset::kLive;
  params.initialisation = FlowStart::kExpected;
  params.forward_backward = forward_backward;
  return params;
}

MaskPipelineParams maskParams(bool refine) {
  MaskPipelineParams params;
  params.motion.score = MotionScore::kUncertainty;
  params.refine = params.refine_ground = refine;
  params.look_back = true;
  params.memory = 0.4;
  return params;
}

/// A street and what the nodelets have made of its first image.
struct Stage {
  Stage() {
    // What an image costs: the other core may work on another one.
    cv::setNumThreads(1);
    first.onGrid(kWorkingWidth, 1);
    second.onGrid(kWorkingWidth, 1);
    pair.depth = pair.next_depth = depth->estimate(street.depthInput(grid));
    pair.camera = grid;
    pair.pixel_scale = static_cast<double>(kCamera.width) / kWorkingWidth;
    pair.T_base_from_camera = street.T_base_from_camera;
    pair.T_first_from_second = street.T_first_from_second;
    pair.flow = flowOf(true);
  }
  FlowField flowOf(bool forward_backward) {
    const auto& flow = forward_backward ? there_and_back : there;
    const cv::Mat expected = expectedFlow(
        grid, staticPointMotion(street.T_base_from_camera, street.T_first_from_second), pair.depth);
    return flow->compute(first.onGrid(kWorkingWidth, 1), second.onGrid(kWorkingWidth, 1), expected);
  }

  const tbb::global_control limit{tbb::global_control::max_allowed_parallelism, 1};
  const Street street;
  const CameraIntrinsics grid = kCamera.scaledTo(kWorkingWidth, kWorkingWidth * 9 / 16);
  const std::unique_ptr<OpticalFlow> there = makeOpticalFlow(flowParams(false)),
                                     there_and_back = makeOpticalFlow(flowParams(true));
  const std::unique_ptr<DepthEstimator> depth = makeDepthEstimator({});
  LazyImage first{street.first}, second{street.second};
  MaskPair pair;
};

Stage& stage() {
  static Stage instance;
  return instance;
}

void decode(benchmark::State& state) {
  const sensor_msgs::CompressedImageConstPtr& jpeg = stage().street.second;
  for (auto _ : state) {
    LazyImage image(jpeg);
    benchmark::DoNotOptimize(image.onGrid(kWorkingWidth, 1).data);
  }
}

void depth(benchmark::State& state) {
  Stage& s = stage();
  for (auto _ : state) benchmark::DoNotOptimize(s.depth->estimate(s.street.depthInput(s.grid)));
}

void flowThere(benchmark::State& state) {
  Stage& s = stage();
  for (auto _ : state) benchmark::DoNotOptimize(s.flowOf(false));
}

void flowThereAndBack(benchmark::State& state) {
  Stage& s = stage();
  for (auto _ : state) benchmark::DoNotOptimize(backwardField(s.flowOf(true), flowParams(true)));
}

/// Forward and backward flow as messages, as they are published.
void messages(benchmark::State& state) {
  const FlowField& field = stage().pair.flow;
  for (auto _ : state)
    for (int i = 0; i < 2; ++i)
      benchmark::DoNotOptimize(flowMessage({}, {}, field, {kCamera.width, kCamera.height}));
}

/// The masks of a stream, each looking back to the previous one.
void masks(benchmark::State& state, bool refine) {
  MaskPipeline pipeline(maskParams(refine));
  MaskPair pair = stage().pair;
  const FlowField back = backwardField(pair.flow, flowParams(true));
  MaskOutcome outcome;
  const auto next = [&] {
    pair.first_time = pair.second_time;
    pair.second_time += kInterval;
    outcome = pipeline.process(pair);
    pipeline.addBackward(pair.second_time, pair.first_time, back);
  };
  next();
  // Its own pair alone judges it: the same pair over and over is no stream that makes sense.
  const cv::Mat first_mask = outcome.result.mask;
  for (auto _ : state) next();
  if (!outcome.looked_back) state.SkipWithError("the pair before is not used");
  if (!refine) return;  // the mover pulls at no motion, but the ground is wrong
  const double scale = 1.0 / pair.pixel_scale;
  const cv::Rect mover(cv::Point(kMover.tl() * scale), cv::Size(kMover.width * 2 / 5, kMover.height * 2 / 5));
  if (cv::countNonZero(first_mask(mover)) < mover.area() / 2) state.SkipWithError("the mover is not found");
}

BENCHMARK(decode)->Unit(benchmark::kMillisecond);
BENCHMARK(depth)->Unit(benchmark::kMillisecond);
BENCHMARK(flowThere)->Unit(benchmark::kMillisecond);
BENCHMARK(flowThereAndBack)->Unit(benchmark::kMillisecond);
BENCHMARK(messages)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(masks, withoutRefinement, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(masks, refined, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace radar_dot

BENCHMARK_MAIN();
