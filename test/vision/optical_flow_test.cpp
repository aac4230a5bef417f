// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/optical_flow.h"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "fixtures/refusal.h"
#include "radar_dot/common/quantile.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {
std::atomic<int> threads_started{0};
}
/// In place of that of the system, which it calls.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*),
                              void* argument) noexcept {
  ++threads_started;
  static const auto start = reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  return start(thread, attributes, body, argument);
}
#endif

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A picture with structure of all sizes, larger than any crop of it.
cv::Mat texture() {
  std::mt19937 random(7);
  cv::Mat sum(500, 800, CV_32FC1, cv::Scalar(0.0));
  for (const int cell : {4, 16, 64}) {
    cv::Mat nodes(500 / cell + 2, 800 / cell + 2, CV_32FC1);
    for (int row = 0; row < nodes.rows; ++row)
      for (int column = 0; column < nodes.cols; ++column)
        nodes.at<float>(row, column) = static_cast<float>(static_cast<double>(random()) / 4294967296.0);
    cv::Mat layer;
    cv::resize(nodes, layer, sum.size(), 0.0, 0.0, cv::INTER_CUBIC);
    sum += 80.0 * layer;
  }
  cv::Mat picture;
  sum.convertTo(picture, CV_8U);
  return picture;
}

/// The picture seen through a window; a window further right sees everything move to the left.
cv::Mat window(int x, int y) { return texture()(cv::Rect(x, y, 480, 320)).clone(); }

/// Median of the flow's two components in the middle of the picture, px of its grid.
cv::Vec2f middle(const cv::Mat& flow) {
  std::vector<float> u;
  std::vector<float> v;
  for (int row = flow.rows / 4; row < 3 * flow.rows / 4; ++row) {
    for (int column = flow.cols / 4; column < 3 * flow.cols / 4; ++column) {
      u.push_back(flow.at<cv::Vec2f>(row, column)[0]);
      v.push_back(flow.at<cv::Vec2f>(row, column)[1]);
    }
  }
  return {quantileOf(u), quantileOf(v)};
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// OpenCV keeps 800 bytes for every thread that ever called it: a thread for each pair would fill the memory
// of a process that runs for days.
TEST(DisFlow, PairsStartNoThreadsOfTheirOwn) {
  OpticalFlowParams params;
  params.working_width = 160;
  params.forward_backward = true;
  const auto flow = makeOpticalFlow(params);
  threads_started = 0;
  std::thread([] {}).join();
  EXPECT_EQ(threads_started, 1) << "they are counted";
  for (int pair = 0; pair < 100; ++pair) flow->compute(window(20, 20), window(22, 20));
  EXPECT_LT(threads_started, 50) << "no more than a pool has";
}
#endif

TEST(DisFlow, FindsAShiftWithItsSign) {
  for (const FlowPreset preset : {FlowPreset::kMedium, FlowPreset::kLive}) {
    OpticalFlowParams params;
    params.working_width = 0;
    params.preset = preset;
    params.forward_backward = true;
    const FlowField field = makeOpticalFlow(params)->compute(window(100, 80), window(92, 83));
    ASSERT_EQ(field.flow.size(), cv::Size(480, 320));
    EXPECT_NEAR(middle(field.flow)[0], 8.0, 0.2);
    EXPECT_NEAR(middle(field.flow)[1], -3.0, 0.2);
    EXPECT_GT(cv::countNonZero(field.valid), 480 * 320 * 8 / 10);
  }
}

// Who decodes images need not give more than that.
TEST(DisFlow, GreyOnTheGridIsAsGoodAsTheWholeImage) {
  OpticalFlowParams params;
  params.working_width = 240;
  const std::unique_ptr<OpticalFlow> flow = makeOpticalFlow(params);
  ASSERT_TRUE(flow->takesGreyGrid());
  const cv::Mat first = window(100, 80), second = window(92, 84);
  cv::Mat small_first, small_second;
  cv::resize(first, small_first, cv::Size(240, 160), 0.0, 0.0, cv::INTER_AREA);
  cv::resize(second, small_second, cv::Size(240, 160), 0.0, 0.0, cv::INTER_AREA);
  EXPECT_EQ(cv::norm(flow->compute(first, second).flow, flow->compute(small_first, small_second).flow), 0.0);
}

TEST(DisFlow, FlowIsInPixelsOfItsGrid) {
  OpticalFlowParams params;
  params.working_width = 240;
  cv::Mat first;
  cv::Mat second;
  cv::cvtColor(window(100, 80), first, cv::COLOR_GRAY2BGR);
  cv::cvtColor(window(92, 84), second, cv::COLOR_GRAY2BGR);
  const FlowField field = makeOpticalFlow(params)->compute(first, second);
  ASSERT_EQ(field.flow.size(), cv::Size(240, 160));
  EXPECT_NEAR(middle(field.flow)[0], 4.0, 0.2);
  EXPECT_NEAR(middle(field.flow)[1], -2.0, 0.2);
}

// Halving the images turns an odd number of pixels into a number of pixels and a half.
TEST(DisFlow, FindsHalfPixels) {
  OpticalFlowParams params;
  params.working_width = 240;
  const FlowField field = makeOpticalFlow(params)->compute(window(100, 80), window(93, 81));
  EXPECT_NEAR(middle(field.flow)[0], 3.5, 0.1);
  EXPECT_NEAR(middle(field.flow)[1], -0.5, 0.1);
}

TEST(DisFlow, NeverEnlargesTheImages) {
  OpticalFlowParams params;
  params.working_width = 4000;
  params.forward_backward = false;
  const FlowField field = makeOpticalFlow(params)->compute(window(100, 80), window(92, 83));
  EXPECT_EQ(field.flow.size(), cv::Size(480, 320));
  EXPECT_TRUE(field.valid.empty());
}

// The start value is wrong by 5 px, unknown in places, and given on a coarser grid.
TEST(DisFlow, ExpectedFlowRescuesALargeMotion) {
  OpticalFlowParams params;
  params.working_width = 0;
  params.preset = FlowPreset::kFine;
  const cv::Mat first = window(300, 80);
  const cv::Mat second = window(160, 80);
  EXPECT_GT(std::abs(middle(makeOpticalFlow(params)->compute(first, second).flow)[0] - 140.0F), 5.0F);
  params.initialisation = FlowStart::kExpected;
  params.forward_backward = true;
  cv::Mat expected(160, 240, CV_32FC2, cv::Scalar(67.5, 0.0));
  expected(cv::Rect(100, 60, 20, 20)).setTo(cv::Scalar(std::nan(""), std::nan("")));
  const FlowField rescued = makeOpticalFlow(params)->compute(first, second, expected);
  EXPECT_NEAR(middle(rescued.flow)[0], 140.0, 1.0);
  // Of 480 columns 340 stay in sight, and the way back must be rescued too for them to close.
  EXPECT_GT(cv::countNonZero(rescued.valid), 340 * 320 * 8 / 10);
  EXPECT_EQ(cv::countNonZero(rescued.valid.colRange(345, 480)), 0);
}

// What comes nearer fills four pixels with one: the start of the way back must not have holes between them.
TEST(DisFlow, ExpectedFlowOfAnApproachRescuesTheWayBack) {
  OpticalFlowParams params;
  params.working_width = 0;
  params.initialisation = FlowStart::kExpected;
  params.forward_backward = true;
  constexpr double kGrows = 2.2;
  const cv::Mat first = window(160, 90);
  cv::Mat second, expected(first.size(), CV_32FC2);
  const cv::Matx23d into_second(kGrows, 0.0, 240.0 * (1.0 - kGrows), 0.0, kGrows, 160.0 * (1.0 - kGrows));
  cv::warpAffine(first, second, into_second, first.size());
  const auto growsBy = [](int u, int v, double share) {
    return cv::Vec2f(static_cast<float>(share * (u - 240)), static_cast<float>(share * (v - 160)));
  };
  for (int v = 0; v < expected.rows; ++v)
    for (int u = 0; u < expected.cols; ++u) expected.at<cv::Vec2f>(v, u) = growsBy(u, v, kGrows - 1.0);
  const FlowField field = makeOpticalFlow(params)->compute(first, second, expected);
  int wrong = 0;
  for (int v = 0; v < expected.rows; ++v)
    for (int u = 0; u < expected.cols; ++u)
      if (cv::norm(field.backward.at<cv::Vec2f>(v, u) - growsBy(u, v, 1.0 / kGrows - 1.0)) > 1.0) ++wrong;
  EXPECT_LT(wrong, 480 * 320 / 100);
}

TEST(DisFlow, ExpectedFlowIsOnlyAStart) {
  OpticalFlowParams params;
  params.working_width = 0;
  params.initialisation = FlowStart::kExpected;
  const cv::Mat wrong(320, 480, CV_32FC2, cv::Scalar(20.0, 6.0));
  const cv::Mat unknown(320, 480, CV_32FC2, cv::Scalar::all(std::nan("")));
  // Points that the camera is about to pass.
  const cv::Mat endless(320, 480, CV_32FC2, cv::Scalar(9e4, -7e5));
  for (const cv::Mat& expected : {wrong, unknown, endless, cv::Mat()}) {
    const cv::Vec2f found =
        middle(makeOpticalFlow(params)->compute(window(100, 80), window(92, 83), expected).flow);
    EXPECT_NEAR(found[0], 8.0, 0.3);
    EXPECT_NEAR(found[1], -3.0, 0.3);
  }
  const cv::Mat one_channel(320, 480, CV_32FC1, cv::Scalar(0.0));
  EXPECT_THROW(makeOpticalFlow(params)->compute(window(100, 80), window(92, 83), one_channel),
               std::invalid_argument);
}

// 140 px are too many at once, but not after pairs that moved by 35, 70 and 105 px.
TEST(DisFlow, TemporalStartFollowsAMotionThatGrows) {
  OpticalFlowParams params;
  params.working_width = 0;
  params.preset = FlowPreset::kFine;
  params.initialisation = FlowStart::kTemporal;
  const std::unique_ptr<OpticalFlow> flow = makeOpticalFlow(params);
  EXPECT_GT(std::abs(middle(flow->compute(window(300, 80), window(160, 80)).flow)[0] - 140.0F), 5.0F);
  flow->reset();
  for (const int shift : {35, 70, 105}) flow->compute(window(300, 80), window(300 - shift, 80));
  EXPECT_NEAR(middle(flow->compute(window(300, 80), window(160, 80)).flow)[0], 140.0, 1.0);
}

TEST(DisFlow, TemporalStartIsForgottenOnReset) {
  OpticalFlowParams params;
  params.working_width = 0;
  params.initialisation = FlowStart::kTemporal;
  const std::unique_ptr<OpticalFlow> flow = makeOpticalFlow(params);
  const FlowField before = flow->compute(window(100, 80), window(90, 80));
  flow->compute(window(90, 80), window(80, 80));
  flow->reset();
  const FlowField after = flow->compute(window(100, 80), window(90, 80));
  EXPECT_EQ(cv::norm(before.flow, after.flow, cv::NORM_INF), 0.0);
}

TEST(ForwardBackward, KnowsWhatCloses) {
  FlowField field;
  field.flow = cv::Mat(10, 10, CV_32FC2, cv::Scalar(2.0, 0.0));
  cv::Mat backward(10, 10, CV_32FC2, cv::Scalar(-2.0, 0.0));
  backward.at<cv::Vec2f>(4, 6) = cv::Vec2f(3.0F, 0.0F);  // where (4, 4) leads: something else moved there
  field.flow.at<cv::Vec2f>(7, 3) = cv::Vec2f(kNaN, 0.0F);
  closeForwardBackward(field, backward, 0.5, 0.0);
  const cv::Mat& valid = field.valid;
  EXPECT_EQ(valid.at<std::uint8_t>(2, 2), 255);
  EXPECT_EQ(valid.at<std::uint8_t>(4, 4), 0);
  EXPECT_EQ(valid.at<std::uint8_t>(7, 3), 0);
  EXPECT_EQ(valid.at<std::uint8_t>(2, 7), 255);  // leads to the last column
  EXPECT_EQ(valid.at<std::uint8_t>(2, 8), 0);    // leads outside
  EXPECT_EQ(cv::countNonZero(valid), 10 * 8 - 2);
}

// Stripes of 8 px whose edges are 20 grey values from px to px: rms 10 where one px of four is an edge.
TEST(TextureStd, SaysHowFarFlowIsToBeTrusted) {
  cv::Mat picture(240, 520, CV_8UC1, cv::Scalar(100));
  for (int u = 260; u < 520; ++u) picture.col(u).setTo(u % 16 < 8 ? 80 : 120);
  const cv::Mat stds = textureStd(picture);
  ASSERT_EQ(stds.size(), picture.size());
  EXPECT_NEAR(stds.at<float>(120, 400), 0.2, 0.1);  // px
  EXPECT_GT(stds.at<float>(120, 100), 100.0F);
}

TEST(ResizeFlow, ScalesItsVectors) {
  const cv::Mat flow(20, 40, CV_32FC2, cv::Scalar(3.0, 2.0));
  const cv::Mat large = resizeFlow(flow, cv::Size(80, 60));
  EXPECT_FLOAT_EQ(large.at<cv::Vec2f>(30, 40)[0], 6.0F);
  EXPECT_FLOAT_EQ(large.at<cv::Vec2f>(30, 40)[1], 6.0F);
  const cv::Mat small = resizeFlow(flow, cv::Size(20, 5));
  EXPECT_FLOAT_EQ(small.at<cv::Vec2f>(2, 10)[0], 1.5F);
  EXPECT_FLOAT_EQ(small.at<cv::Vec2f>(2, 10)[1], 0.5F);
  EXPECT_THROW(resizeFlow(flow, cv::Size()), std::invalid_argument);
  EXPECT_THROW(resizeFlow(cv::Mat(), cv::Size(4, 4)), std::invalid_argument);
}

TEST(OpticalFlow, BackendsPlugInByName) {
  struct Still : OpticalFlow {
    FlowField compute(const cv::Mat& first, const cv::Mat&, const cv::Mat&) override {
      return {cv::Mat::zeros(first.size(), CV_32FC2), {}};
    }
  };
  registerOpticalFlow("still", [](const OpticalFlowParams&) { return std::make_unique<Still>(); });
  OpticalFlowParams params;
  params.backend = "still";
  EXPECT_EQ(cv::norm(makeOpticalFlow(params)->compute(window(0, 0), window(9, 9), {}).flow), 0.0);
  EXPECT_THROW(registerOpticalFlow("none", {}), std::invalid_argument);
}

TEST(OpticalFlow, NamesOfBackendsLeadNowhereElse) {
  for (const char* name : {"../dis", "a/b", "", "Torch"}) {
    OpticalFlowParams params;
    params.backend = name;
    test::expectRefusal([&params] { makeOpticalFlow(params); }, {"no backend", "dis"});
  }
}

#ifndef RADAR_DOT_HAS_TORCH
TEST(OpticalFlow, WithoutLibtorchTheRefusalSaysHowToGetIt) {
  OpticalFlowParams params;
  params.backend = "torch";
  test::expectRefusal([&params] { makeOpticalFlow(params); },
                      {"no backend 'torch'", "libtorch-dev", "Torch_DIR"});
}
#endif

void expectRefusal(const OpticalFlowParams& params, const std::string& part) {
  test::expectRefusal([&params] { makeOpticalFlow(params); }, {part});
}

TEST(OpticalFlow, RefusalsNameWhatThereIs) {
  OpticalFlowParams params;
  params.backend = "magic";
  expectRefusal(params, "dis");
  params = {};
  params.working_width = -1;
  expectRefusal(params, "working_width");
  params = {};
  params.forward_backward_absolute = std::nan("");
  expectRefusal(params, "forward_backward");
  const std::unique_ptr<OpticalFlow> flow = makeOpticalFlow();
  EXPECT_THROW(flow->compute({}, window(0, 0)), std::invalid_argument);
  EXPECT_THROW(flow->compute(window(0, 0), window(0, 0)(cv::Rect(0, 0, 100, 100))), std::invalid_argument);
  EXPECT_THROW(flow->compute(cv::Mat(9, 9, CV_32FC1), cv::Mat(9, 9, CV_32FC1)), std::invalid_argument);
}

// OpenCV's DIS reads outside images like these.
TEST(OpticalFlow, RefusesGridsTooSmallForDis) {
  for (const EnumName<FlowPreset>& preset : EnumNames<FlowPreset>::kValues) {
    OpticalFlowParams params;
    params.preset = preset.value;
    const std::unique_ptr<OpticalFlow> flow = makeOpticalFlow(params);
    const cv::Mat narrow(26, 330, CV_8UC1, cv::Scalar(9));
    EXPECT_THROW(flow->compute(narrow, narrow), std::invalid_argument);
    const cv::Mat smallest(32, 330, CV_8UC1, cv::Scalar(9));
    EXPECT_EQ(flow->compute(smallest, smallest).flow.size(), cv::Size(330, 32));
  }
}

}  // namespace
}  // namespace radar_dot
