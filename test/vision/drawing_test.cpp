// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
const cv::Vec3b kGrey(64, 64, 64);

cv::Mat flowOf(float x, float y, cv::Size size = {8, 8}) { return cv::Mat(size, CV_32FC2, cv::Scalar(x, y)); }
cv::Mat valueOf(double value, cv::Size size = {8, 8}) { return cv::Mat(size, CV_32FC1, cv::Scalar(value)); }

cv::Vec3b colourOfFlow(float x, float y, double max_flow) {
  return drawFlow(flowOf(x, y), max_flow).at<cv::Vec3b>(3, 3);
}
cv::Vec3b colourOfDepth(float depth) { return drawDepth(valueOf(depth), 120.0).at<cv::Vec3b>(3, 3); }
cv::Vec3b colourOfResidual(float value) { return drawResidual(valueOf(value), 8.0).at<cv::Vec3b>(3, 3); }

cv::Vec3b colourOfMap(int index, int map) {
  cv::Mat colour;
  cv::applyColorMap(cv::Mat(1, 1, CV_8UC1, cv::Scalar(index)), colour, map);
  return colour.at<cv::Vec3b>(0, 0);
}

/// Degrees.
double hueOf(const cv::Vec3b& bgr) {
  cv::Mat hsv;
  cv::cvtColor(cv::Mat(1, 1, CV_32FC3, cv::Scalar(bgr[0] / 255.0, bgr[1] / 255.0, bgr[2] / 255.0)), hsv,
               cv::COLOR_BGR2HSV);
  return static_cast<double>(hsv.at<cv::Vec3f>(0, 0)[0]);
}

double hueDifference(const cv::Vec3b& a, const cv::Vec3b& b) {
  return std::fabs(std::remainder(hueOf(a) - hueOf(b), 360.0));
}

int largestDifference(const cv::Vec3b& a, const cv::Vec3b& b) {
  int largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

int changedPixels(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat distance, grey;
  cv::absdiff(a, b, distance);
  cv::transform(distance, grey, cv::Matx13f(1.0F, 1.0F, 1.0F));
  return cv::countNonZero(grey);
}

void expectNamed(const std::function<void()>& call, const std::string& name) {
  const std::string text = test::refusalOf(call);
  EXPECT_EQ(text.rfind(name + " is ", 0), 0U) << text;
}

// The four corners of the published wheel: 55 steps, counted from red at the right over yellow (15).
TEST(DrawFlow, DirectionsHaveTheHuesOfTheMiddleburyWheel) {
  EXPECT_LE(largestDifference(colourOfFlow(9, 0, 9), {0, 0, 255}), 1);
  EXPECT_LE(largestDifference(colourOfFlow(0, 9, 9), {0, 234, 255}), 4);   // step 13.75
  EXPECT_LE(largestDifference(colourOfFlow(-9, 0, 9), {255, 197, 0}), 4);  // step 27.5
  EXPECT_LE(largestDifference(colourOfFlow(0, -9, 9), {255, 0, 103}), 4);  // step 41.25
}

TEST(DrawFlow, OppositeDirectionsHaveOppositeHues) {
  for (int degrees = 0; degrees < 180; degrees += 5) {
    const auto x = static_cast<float>(std::cos(degrees * CV_PI / 180.0));
    const auto y = static_cast<float>(std::sin(degrees * CV_PI / 180.0));
    EXPECT_GT(hueDifference(colourOfFlow(x, y, 1.0), colourOfFlow(-x, -y, 1.0)), 140.0) << degrees;
  }
}

TEST(DrawFlow, HueIsTheDirectionWhateverTheMagnitude) {
  for (const float size : {0.25F, 0.5F, 2.0F, 50.0F})
    EXPECT_LT(hueDifference(colourOfFlow(0.6F * size, -0.8F * size, 1.0), colourOfFlow(0.6F, -0.8F, 1.0)),
              4.0);
}

TEST(DrawFlow, NoMotionIsWhiteAndUnknownIsGrey) {
  EXPECT_EQ(colourOfFlow(0, 0, 5), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(colourOfFlow(kNaN, 0, 5), kGrey);
  EXPECT_EQ(colourOfFlow(0, kNaN, 5), kGrey);
  EXPECT_EQ(colourOfFlow(-kInfinity, 0, 5), kGrey);
}

TEST(DrawFlow, SaturationGrowsWithTheMagnitudeUpToTheLargest) {
  for (const cv::Vec2f& direction : {cv::Vec2f(1, 0), cv::Vec2f(-0.6F, 0.8F), cv::Vec2f(0, -1)}) {
    int last = 256;
    for (int step = 0; step <= 20; ++step) {
      const cv::Vec2f flow = 0.5F * static_cast<float>(step) * direction;
      const cv::Vec3b colour = colourOfFlow(flow[0], flow[1], 10.0);
      const int white = std::min({colour[0], colour[1], colour[2]});
      EXPECT_LT(white, last) << step;
      last = white;
    }
    EXPECT_LE(last, 1);
    EXPECT_EQ(colourOfFlow(30 * direction[0], 30 * direction[1], 10.0),
              colourOfFlow(10 * direction[0], 10 * direction[1], 10.0));
  }
}

TEST(DrawFlow, TheScaleOfAFieldIgnoresFewWildVectorsAndUnknownOnes) {
  cv::Mat flow = flowOf(-3, 4, {100, 100});
  EXPECT_DOUBLE_EQ(flowScale(flow), 5.0);
  flow.row(0).setTo(cv::Scalar(900, 0));
  EXPECT_DOUBLE_EQ(flowScale(flow), 5.0);
  flow.rowRange(1, 40).setTo(cv::Scalar(kNaN, 0));
  EXPECT_DOUBLE_EQ(flowScale(flow), 5.0);
  EXPECT_EQ(changedPixels(drawFlow(flow), drawFlow(flow, 5.0)), 0);
  EXPECT_DOUBLE_EQ(flowScale(flowOf(5.1F, 0)), 6.0);
  EXPECT_DOUBLE_EQ(flowScale(flowOf(0, 120)), 150.0);
  EXPECT_DOUBLE_EQ(flowScale(flowOf(0, 0.01F)), 1.0);
  EXPECT_DOUBLE_EQ(flowScale(flowOf(kNaN, 0)), 1.0);
  EXPECT_DOUBLE_EQ(flowScale(flowOf(2, 0), flowOf(40, 0)), 40.0);
  EXPECT_DOUBLE_EQ(flowScale({}, flowOf(40, 0)), 40.0);
}

TEST(DrawFlow, TheLegendShowsTheColourOfEachDirectionInThatDirection) {
  // 24 px leave no room for text: the wheel has its middle at 11.5 and a radius of 10.
  const cv::Mat legend = drawFlowLegend(24, 7.0);
  ASSERT_EQ(legend.size(), cv::Size(24, 24));
  for (const cv::Point& offset : {cv::Point(6, 0), cv::Point(-6, 0), cv::Point(0, 6), cv::Point(0, -6)}) {
    const cv::Vec3b expected =
        colourOfFlow(0.6F * static_cast<float>(offset.x), 0.6F * static_cast<float>(offset.y), 6.0);
    EXPECT_LT(hueDifference(legend.at<cv::Vec3b>(11 + offset.y, 11 + offset.x), expected), 20.0) << offset;
  }
  EXPECT_EQ(legend.at<cv::Vec3b>(0, 0), legend.at<cv::Vec3b>(23, 23)) << "round";
  EXPECT_GT(changedPixels(drawFlowLegend(120, 7.0), drawFlowLegend(120, 8.0)), 0) << "scale written";
}

TEST(DrawDepth, IsLogarithmicFromASixtiethOfTheLargest) {
  EXPECT_EQ(colourOfDepth(2.0F), colourOfMap(255, cv::COLORMAP_PLASMA));
  EXPECT_EQ(colourOfDepth(0.5F), colourOfDepth(2.0F));
  EXPECT_EQ(colourOfDepth(120.0F), colourOfMap(0, cv::COLORMAP_PLASMA));
  EXPECT_EQ(colourOfDepth(500.0F), colourOfDepth(120.0F));
  // Half of the way on a logarithmic scale is the geometric mean.
  EXPECT_LE(largestDifference(colourOfDepth(std::sqrt(2.0F * 120.0F)), colourOfMap(127, cv::COLORMAP_PLASMA)),
            2);
}

TEST(DrawDepth, UnknownIsGrey) {
  for (const float unknown : {kNaN, 0.0F, -3.0F, kInfinity})
    EXPECT_EQ(colourOfDepth(unknown), kGrey) << unknown;
}

TEST(DrawResidual, IsAScaleOfSquareRoots) {
  EXPECT_EQ(colourOfResidual(0.0F), colourOfMap(0, cv::COLORMAP_INFERNO));
  EXPECT_LE(largestDifference(colourOfResidual(2.0F), colourOfMap(127, cv::COLORMAP_INFERNO)), 3);
  EXPECT_EQ(colourOfResidual(8.0F), colourOfMap(255, cv::COLORMAP_INFERNO));
  EXPECT_EQ(colourOfResidual(80.0F), colourOfResidual(8.0F));
  EXPECT_EQ(colourOfResidual(kNaN), kGrey);
  EXPECT_EQ(changedPixels(drawResidual(valueOf(7.3)), drawResidual(valueOf(7.3), 8.0)), 0)
      << "7.3 rounds up to 8";
}

TEST(DrawScale, IsInTheLowerRightCornerOfPicturesThatAreLargeEnough) {
  const cv::Size large(640, 360);
  for (const cv::Mat& picture : {drawDepth(valueOf(10.0, large)), drawResidual(valueOf(3.0, large), 8.0)}) {
    const cv::Mat plain(large, CV_8UC3, picture.at<cv::Vec3b>(0, 0));
    const cv::Rect corner(320, 300, 320, 60);
    EXPECT_GT(changedPixels(picture(corner), plain(corner)), 3000);
    EXPECT_EQ(changedPixels(picture, plain), changedPixels(picture(corner), plain(corner)));
  }
  const cv::Mat small = drawDepth(valueOf(10.0, {160, 90}));
  EXPECT_EQ(changedPixels(small, cv::Mat(small.size(), CV_8UC3, small.at<cv::Vec3b>(0, 0))), 0);
}

cv::Mat plainImage(cv::Size size = {640, 360}) { return cv::Mat(size, CV_8UC3, cv::Scalar(100, 120, 140)); }

TEST(DrawRadar, StaticIsGreenDynamicRedOnADarkerImage) {
  const cv::Mat picture = drawRadar(plainImage(), {{{100, 100}, 20, 0, false}, {{400, 200}, 20, -3, true}});
  const auto green = picture.at<cv::Vec3b>(100, 100), red = picture.at<cv::Vec3b>(200, 400);
  EXPECT_GT(green[1], 2 * std::max(green[0], green[2]));
  EXPECT_GT(red[2], 2 * std::max(red[0], red[1]));
  const auto background = picture.at<cv::Vec3b>(300, 300);
  for (int c = 0; c < 3; ++c) EXPECT_LT(background[c], 0.6 * plainImage().at<cv::Vec3b>(0, 0)[c]);
}

TEST(DrawRadar, NearReturnsAreLarger) {
  const cv::Mat none = drawRadar(plainImage(), {});
  int last = 0;
  for (const float depth : {100.0F, 30.0F, 10.0F, 3.0F}) {
    const int area = changedPixels(drawRadar(plainImage(), {{{320, 180}, depth, 0, false}}), none);
    EXPECT_GT(area, last) << depth;
    last = area;
  }
}

TEST(DrawRadar, DynamicReturnsLieOverStaticOnesInAnyOrder) {
  const RadarPixel still{{320, 180}, 5, 0, false};
  const RadarPixel moving{{320, 180}, 50, 2, true};
  for (const auto& points : {std::vector<RadarPixel>{still, moving}, {moving, still}})
    EXPECT_GT(drawRadar(plainImage(), points).at<cv::Vec3b>(180, 320)[2], 200);
}

TEST(DrawRadar, WhatTheCameraDoesNotSeeIsLeftOut) {
  const cv::Mat none = drawRadar(plainImage(), {});
  for (const RadarPixel& point : {RadarPixel{{-2, 100}, 20, 0, false}, RadarPixel{{100, 361}, 20, 0, false},
                                  RadarPixel{{kNaN, 100}, 20, 0, true}, RadarPixel{{100, 100}, -1, 0, true},
                                  RadarPixel{{100, 100}, kNaN, 0, true}, RadarPixel{{1e30F, 1}, 20, 0, true}})
    EXPECT_EQ(changedPixels(drawRadar(plainImage(), {point}), none), 0) << point.pixel;
}

TEST(OverlayMask, ChangesThePixelsOfTheMaskAndNoOthers) {
  const cv::Mat image = plainImage({200, 120});
  cv::Mat mask(image.size(), CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(50, 30, 40, 20)).setTo(1);
  mask.at<uchar>(100, 150) = 255;
  const cv::Mat picture = overlayMask(image, mask);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      ASSERT_EQ(picture.at<cv::Vec3b>(v, u) != image.at<cv::Vec3b>(v, u), mask.at<uchar>(v, u) != 0)
          << u << " " << v;
  EXPECT_NE(picture.at<cv::Vec3b>(30, 50), picture.at<cv::Vec3b>(40, 70)) << "contour and inside";
  EXPECT_EQ(picture.at<cv::Vec3b>(30, 50), picture.at<cv::Vec3b>(49, 89)) << "all around";
}

TEST(OverlayMask, TheMaskMayHaveAGridOfItsOwn) {
  const cv::Mat image = plainImage({200, 120});
  cv::Mat mask(60, 100, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(25, 15, 20, 10)).setTo(255);
  const cv::Mat picture = overlayMask(image, mask);
  const cv::Rect marked(50, 30, 40, 20);
  EXPECT_EQ(changedPixels(picture, image), marked.area());
  EXPECT_EQ(changedPixels(picture(marked), image(marked)), marked.area());
}

TEST(OverlayMask, ExcludedPixelsAreDarkerAndHatched) {
  const cv::Mat image = plainImage({200, 120});
  cv::Mat valid(image.size(), CV_8UC1, cv::Scalar(255));
  const cv::Rect excluded(100, 0, 100, 120);
  valid(excluded).setTo(0);
  const cv::Mat picture = overlayMask(image, cv::Mat(image.size(), CV_8UC1, cv::Scalar(0)), valid);
  EXPECT_EQ(changedPixels(picture, image), excluded.area());
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture(excluded), mean, deviation);
  EXPECT_LT(mean[0], 85.0);
  EXPECT_GT(deviation[0], 5.0);
}

/// The middle of the panel in this column and row.
cv::Vec3b middleOf(const cv::Mat& figure, int column, int row, cv::Size panel = {640, 360}) {
  return figure.at<cv::Vec3b>(row * panel.height + panel.height / 2, column * panel.width + panel.width / 2);
}

SixPanelInput sixInputs() {
  SixPanelInput input;
  input.image = plainImage({1600, 900});
  input.expected_flow = flowOf(10, 0, {800, 450});  // 20 px of the image
  input.observed_flow = flowOf(0, -20, {1600, 900});
  input.residual = valueOf(2.0, {400, 225});
  input.max_residual = 8.0;
  input.depth = valueOf(2.0, {100, 56});
  input.radar = std::vector<RadarPixel>{{{800, 450}, 10.0F, 4.0F, true}};
  return input;
}

TEST(SixPanel, ShowsThePaperFigureFromTopLeftToBottomRight) {
  const cv::Mat figure = sixPanel(sixInputs());
  ASSERT_EQ(figure.size(), cv::Size(1920, 720));
  EXPECT_EQ(middleOf(figure, 0, 0), cv::Vec3b(100, 120, 140));
  EXPECT_EQ(middleOf(figure, 1, 0), colourOfResidual(2.0F));
  EXPECT_EQ(middleOf(figure, 2, 0), colourOfFlow(20, 0, 20));
  EXPECT_EQ(middleOf(figure, 0, 1), colourOfDepth(2.0F));
  EXPECT_GT(middleOf(figure, 1, 1)[2], 200) << "a dynamic return";
  EXPECT_EQ(middleOf(figure, 2, 1), colourOfFlow(0, -20, 20));
  SixPanelInput masked = sixInputs();
  masked.mask = cv::Mat(450, 800, CV_8UC1, cv::Scalar(255));
  EXPECT_NE(middleOf(sixPanel(masked), 0, 0), cv::Vec3b(100, 120, 140));
}

TEST(SixPanel, BothFlowsShareOneScaleInPixelsOfTheImage) {
  SixPanelInput input = sixInputs();
  input.observed_flow = flowOf(20, 0, {1600, 900});
  input.residual = cv::Mat();
  cv::Mat figure = sixPanel(input);
  EXPECT_EQ(middleOf(figure, 2, 0), middleOf(figure, 2, 1));
  EXPECT_EQ(middleOf(figure, 1, 0), colourOfResidual(0.0F)) << "the difference of the two";
  input.observed_flow = flowOf(22, 0, {1600, 900});
  input.max_flow = 40.0;
  figure = sixPanel(input);
  EXPECT_EQ(middleOf(figure, 1, 0), colourOfResidual(2.0F));
  EXPECT_EQ(middleOf(figure, 2, 0), colourOfFlow(20, 0, 40));
  EXPECT_EQ(middleOf(figure, 2, 1), colourOfFlow(22, 0, 40));
}

TEST(SixPanel, SaysWhatIsMissing) {
  const cv::Mat nothing = sixPanel({});
  ASSERT_EQ(nothing.size(), cv::Size(1920, 720));
  SixPanelInput input = sixInputs();
  input.depth = cv::Mat();
  input.radar.reset();
  const cv::Mat figure = sixPanel(input);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 2; ++row) {
      // Dark, with words across the middle.
      const cv::Mat band = nothing(cv::Rect(column * 640 + 200, row * 360 + 165, 240, 30));
      double brightest = 0.0;
      cv::minMaxLoc(band.reshape(1), nullptr, &brightest);
      EXPECT_GT(brightest, 150.0);
      EXPECT_LT(cv::mean(band)[0], 80.0);
    }
  }
  const cv::Rect depth(2, 362, 636, 356);
  EXPECT_EQ(changedPixels(figure(depth), nothing(depth)), 0);
  EXPECT_EQ(middleOf(figure, 2, 1), colourOfFlow(0, -20, 20)) << "the others are there";
  input.radar.emplace();
  EXPECT_EQ(middleOf(sixPanel(input), 1, 1), drawRadar(input.image, {}).at<cv::Vec3b>(450, 800))
      << "no returns are an answer";
}

TEST(SixPanel, KeepsTheAspectRatioOfItsInputs) {
  SixPanelInput input;
  input.image = plainImage({400, 400});
  const cv::Mat figure = sixPanel(input);
  // 360x360 in the middle of 640x360.
  EXPECT_EQ(figure.at<cv::Vec3b>(180, 139), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(figure.at<cv::Vec3b>(180, 141), cv::Vec3b(100, 120, 140));
  EXPECT_EQ(figure.at<cv::Vec3b>(180, 498), cv::Vec3b(100, 120, 140));
  EXPECT_EQ(figure.at<cv::Vec3b>(180, 501), cv::Vec3b(0, 0, 0));
}

TEST(SixPanel, LeavesItsInputsAlone) {
  SixPanelInput input = sixInputs();
  input.panel = input.image.size();
  const cv::Mat image = input.image.clone(), flow = input.observed_flow.clone();
  input.mask = cv::Mat(image.size(), CV_8UC1, cv::Scalar(255));
  sixPanel(input);
  EXPECT_EQ(cv::norm(image, input.image), 0.0);
  EXPECT_EQ(cv::norm(flow, input.observed_flow), 0.0);
}

TEST(SixPanel, AcceptsSmallPanelsAndGreyImages) {
  SixPanelInput input = sixInputs();
  input.image = cv::Mat(900, 1600, CV_8UC1, cv::Scalar(90));
  input.panel = {64, 36};
  const cv::Mat figure = sixPanel(input);
  ASSERT_EQ(figure.size(), cv::Size(192, 72));
  EXPECT_EQ(middleOf(figure, 0, 0, input.panel), cv::Vec3b(90, 90, 90));
}

TEST(Drawing, ErrorsNameTheArgument) {
  const cv::Mat wrong(8, 8, CV_64FC1, cv::Scalar(0));
  const cv::Mat mask(8, 8, CV_8UC1, cv::Scalar(0));
  expectNamed([&] { drawFlow(wrong); }, "flow");
  expectNamed([&] { drawFlow({}); }, "flow");
  expectNamed([&] { drawFlow(flowOf(1, 1), -1.0); }, "max_flow");
  expectNamed([&] { drawFlow(flowOf(1, 1), kNaN); }, "max_flow");
  expectNamed([&] { flowScale(flowOf(1, 1), wrong); }, "other");
  expectNamed([&] { drawFlowLegend(10, 1.0); }, "size");
  expectNamed([&] { drawFlowLegend(100, 0.0); }, "max_flow");
  expectNamed([&] { drawDepth(wrong); }, "depth");
  expectNamed([&] { drawDepth(valueOf(1), 0.0); }, "max_depth");
  expectNamed([&] { drawResidual(wrong); }, "residual");
  expectNamed([&] { drawResidual(valueOf(1), -2.0); }, "max");
  expectNamed([&] { drawRadar(wrong, {}); }, "image");
  expectNamed([&] { drawRadar({}, {}); }, "image");
  expectNamed([&] { overlayMask(wrong, mask); }, "image");
  expectNamed([&] { overlayMask(plainImage(), wrong); }, "mask");
  expectNamed([&] { overlayMask(plainImage(), mask, wrong); }, "valid");
}

TEST(SixPanel, ErrorsNameTheInput) {
  const cv::Mat wrong(8, 8, CV_64FC1, cv::Scalar(0));
  const auto expectRefused = [](const std::string& name, const std::function<void(SixPanelInput&)>& spoil) {
    SixPanelInput input = sixInputs();
    spoil(input);
    expectNamed([&] { sixPanel(input); }, name);
  };
  expectRefused("image", [&](SixPanelInput& input) { input.image = wrong; });
  expectRefused("mask", [&](SixPanelInput& input) { input.mask = wrong; });
  expectRefused("valid", [&](SixPanelInput& input) { input.valid = wrong; });
  expectRefused("expected_flow", [&](SixPanelInput& input) { input.expected_flow = wrong; });
  expectRefused("observed_flow", [&](SixPanelInput& input) { input.observed_flow = wrong; });
  expectRefused("residual", [&](SixPanelInput& input) { input.residual = wrong; });
  expectRefused("depth", [&](SixPanelInput& input) { input.depth = wrong; });
  expectRefused("max_flow", [](SixPanelInput& input) { input.max_flow = -1.0; });
  expectRefused("max_residual", [](SixPanelInput& input) { input.max_residual = kInfinity; });
  expectRefused("max_depth", [](SixPanelInput& input) { input.max_depth = 0.0; });
  expectRefused("panel", [](SixPanelInput& input) { input.panel = {10, 10}; });
}

}  // namespace
}  // namespace radar_dot
