// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/mask_borders.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {
namespace {

const cv::Size kSize(320, 180);
constexpr double kReach = 12.0;  // px

cv::Mat disc(const cv::Point& centre, int radius) {
  cv::Mat mask = cv::Mat::zeros(kSize, CV_8UC1);
  cv::circle(mask, centre, radius, cv::Scalar(255), cv::FILLED);
  return mask;
}

/// Grey values of what is in the mask and of what is not, with the noise of a camera.
cv::Mat picture(const cv::Mat& mask, int inside, int outside) {
  cv::Mat grey(kSize, CV_8UC1, cv::Scalar(outside)), noise(kSize, CV_8UC1);
  grey.setTo(inside, mask);
  cv::theRNG().state = 7;
  cv::randn(noise, 8.0, 1.5);
  return grey + noise - 8;
}

/// A pattern of what is in a mask.
void addDots(cv::Mat& grey, int by, const cv::Mat& mask) {
  for (int row = 0; row < grey.rows; row += 4)
    for (int column = 0; column < grey.cols; column += 4)
      if (mask.at<std::uint8_t>(row, column) != 0)
        grey.at<std::uint8_t>(row, column) =
            static_cast<std::uint8_t>(grey.at<std::uint8_t>(row, column) + by);
}

/// Of a camera that stands.
ImagePairInput pairOf(const cv::Mat& grey) {
  ImagePairInput pair;
  pair.camera = CameraIntrinsics{200.0, 200.0, 159.5, 89.5, kSize.width, kSize.height};
  pair.depth = cv::Mat(kSize, CV_32FC1, cv::Scalar(20.0));
  pair.flow = cv::Mat(kSize, CV_32FC2, cv::Scalar::all(0.0));
  pair.grey = grey;
  return pair;
}

double overlap(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(cv::countNonZero(a & b)) / cv::countNonZero(a | b);
}

TEST(MaskBorders, MoveToTheEdgesOfWhatIsSeen) {
  const cv::Mat truth = disc({160, 90}, 30);
  const cv::Mat grey = picture(truth, 60, 120);
  for (const cv::Mat& blurred : {disc({160, 90}, 40), disc({165, 95}, 38), disc({160, 90}, 24)}) {
    ASSERT_LT(overlap(blurred, truth), 0.68);
    cv::Mat mask = blurred.clone();
    moveBordersToEdges(mask, pairOf(grey), kReach);
    EXPECT_GT(overlap(mask, truth), 0.95);
  }
}

TEST(MaskBorders, WithTextureButWithoutEdgesTheCoreStays) {
  const cv::Mat flow = disc({160, 90}, 40);
  cv::Mat mask = flow.clone(), grey = picture(flow, 100, 100);
  addDots(grey, 40, cv::Mat(kSize, CV_8UC1, cv::Scalar(255)));
  moveBordersToEdges(mask, pairOf(grey), kReach);
  EXPECT_EQ(cv::countNonZero(disc({160, 90}, 27) & ~mask), 0);
  EXPECT_EQ(cv::countNonZero(mask & ~disc({160, 90}, 40 + static_cast<int>(kReach))), 0);
}

TEST(MaskBorders, WhatMovesLendsItsFlowToSurfacesWithoutTexture) {
  const cv::Mat car = disc({120, 90}, 28);
  cv::Mat grey = picture(car, 60, 120);
  addDots(grey, 40, car);
  const cv::Rect road(120, 75, 90, 40);  // beside it, marked with it
  cv::Mat mask = car.clone();
  mask(road).setTo(255);
  ASSERT_LT(overlap(mask, car), 0.6);
  cv::Mat with_pattern_on_road = grey.clone();
  addDots(with_pattern_on_road, 40, ~car);
  cv::Mat kept = mask.clone();
  moveBordersToEdges(mask, pairOf(grey), kReach);
  EXPECT_GT(overlap(mask, car), 0.85);
  moveBordersToEdges(kept, pairOf(with_pattern_on_road), kReach);
  EXPECT_GT(cv::countNonZero(kept(cv::Rect(170, 85, 15, 20))), 250);  // of 300
}

/// Texture that is found again wherever it goes.
cv::Mat texture() {
  cv::Mat pattern(kSize, CV_8UC1);
  cv::theRNG().state = 3;
  cv::randu(pattern, 0, 120);
  cv::GaussianBlur(pattern, pattern, {5, 5}, 1.2);
  return pattern;
}

/// Another image of a background, with what is in a mask of an image moved to the right by some px.
cv::Mat withMoved(const cv::Mat& background, const cv::Mat& grey, const cv::Mat& what, double by,
                  int brighter = 0) {
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, by, 0, 1, 0);
  cv::Mat moved, to = background.clone(), noise(kSize, CV_8UC1);
  cv::warpAffine(grey & what, moved, shift, kSize);
  moved.copyTo(to, moved > 0);
  cv::randn(noise, 8.0, 1.5);
  return to + noise - 8 + brighter;
}

// The flow says that a car and the road beside it move by 3 px. Both have texture.
TEST(MaskBorders, WhereTheSecondImageShowsTheFirstNothingMoves) {
  const cv::Mat car = disc({120, 90}, 28), marked = car.clone(), none = cv::Mat::zeros(kSize, CV_8UC1);
  marked(cv::Rect(120, 75, 90, 40)).setTo(255);
  ImagePairInput pair = pairOf(picture(none, 0, 80) + texture());
  pair.grey += picture(none, 0, 60) & car;  // a car that is brighter
  pair.flow.setTo(cv::Scalar(3.0, 0.0), marked);
  const auto cut = [&](const cv::Mat& second_grey) {
    pair.second_grey = second_grey;
    cv::Mat mask = marked.clone();
    moveBordersToEdges(mask, pair, kReach);
    return mask;
  };
  const cv::Rect road(170, 85, 30, 20);
  for (const int brighter : {0, 10}) {
    const cv::Mat mask = cut(withMoved(pair.grey, pair.grey, car, 3.0, brighter));
    EXPECT_GT(overlap(mask, car), 0.85);
    EXPECT_EQ(cv::countNonZero(mask(road)), 0);
  }
  EXPECT_GT(cv::countNonZero(cut(withMoved(pair.grey, pair.grey, marked, 3.0))(road)), 500);  // of 600
  EXPECT_GT(cv::countNonZero(cut({})(road)), 500);
}

// A car that moves by 30 px hides the road beside it in the second image. The flow there is that of the car.
TEST(MaskBorders, WhatTheSecondImageHidesStandsAsThePreviousImageShows) {
  const cv::Mat none = cv::Mat::zeros(kSize, CV_8UC1);
  cv::Mat car = none.clone(), marked = none.clone();
  car(cv::Rect(100, 60, 60, 60)).setTo(255);
  marked(cv::Rect(100, 60, 90, 60)).setTo(255);
  const cv::Mat background = picture(none, 0, 80) + texture();
  ImagePairInput pair = pairOf(background + (picture(none, 0, 60) & car));
  pair.second_grey = withMoved(background, pair.grey, car, 30.0);
  pair.flow.setTo(cv::Scalar(30.0, 0.0), marked);
  ImagePairInput before = pair;
  before.flow = -pair.flow;
  before.second_grey = withMoved(background, pair.grey, car, -30.0);
  const cv::Rect hidden(164, 64, 22, 52);
  cv::Mat alone = marked.clone(), both = marked.clone();
  moveBordersToEdges(alone, pair, kReach);
  moveBordersToEdges(both, pair, kReach, &before);
  EXPECT_GT(cv::countNonZero(alone(hidden)), hidden.area() / 3);
  EXPECT_LT(cv::countNonZero(both(hidden)), hidden.area() / 20);
  EXPECT_GT(overlap(both, car), 0.9);
}

TEST(MaskBorders, WhatIsSmallIsKept) {
  const cv::Mat truth = disc({100, 50}, 3);
  cv::Mat mask = disc({100, 50}, 5);
  moveBordersToEdges(mask, pairOf(picture(truth, 40, 120)), kReach);
  EXPECT_GT(overlap(mask, truth), 0.8);
}

TEST(MaskBorders, RegionsFarApartDoNotTouchEachOther) {
  const cv::Mat left = disc({50, 90}, 20), right = disc({270, 60}, 25);
  const cv::Mat grey = picture(left | right, 60, 120);
  cv::Mat alone = disc({50, 90}, 26), both = alone | disc({270, 60}, 33);
  moveBordersToEdges(alone, pairOf(grey), kReach);
  moveBordersToEdges(both, pairOf(grey), kReach);
  EXPECT_EQ(cv::norm(both.colRange(0, 160), alone.colRange(0, 160), cv::NORM_INF), 0.0);
  EXPECT_GT(overlap(both, left | right), 0.97);
}

TEST(MaskBorders, NothingAndEverythingStay) {
  const cv::Mat grey = picture(disc({160, 90}, 30), 60, 120);
  cv::Mat nothing = cv::Mat::zeros(kSize, CV_8UC1), everything(kSize, CV_8UC1, cv::Scalar(255));
  moveBordersToEdges(nothing, pairOf(grey), kReach);
  moveBordersToEdges(everything, pairOf(grey), kReach);
  EXPECT_EQ(cv::countNonZero(nothing), 0);
  EXPECT_EQ(cv::countNonZero(everything), kSize.area());
}

// A square that moves 6 px to the right before a wall that stands; its flow reaches 8 px over its border.
TEST(MaskBorders, AreMovedByTheSegmenterWhereThereIsAnImage) {
  const cv::Rect square(140, 70, 40, 40);
  MotionInput input;
  static_cast<ImagePairInput&>(input) = pairOf({});
  input.flow(cv::Rect(132, 62, 56, 56)).setTo(cv::Scalar(6.0, 0.0));
  cv::Mat truth = cv::Mat::zeros(kSize, CV_8UC1);
  truth(square).setTo(255);
  MotionParams params;
  params.cleanup.border = static_cast<int>(kReach);
  MotionSegmenter segmenter(params);
  EXPECT_LT(overlap(segmenter.segment(input).mask, truth), 0.55);
  input.grey = picture(truth, 60, 120);
  EXPECT_GT(overlap(segmenter.segment(input).mask, truth), 0.95);
}

}  // namespace
}  // namespace radar_dot
