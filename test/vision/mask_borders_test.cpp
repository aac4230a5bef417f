// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/mask_borders.h"

#include <gtest/gtest.h>

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

double overlap(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(cv::countNonZero(a & b)) / cv::countNonZero(a | b);
}

TEST(MaskBorders, MoveToTheEdgesOfWhatIsSeen) {
  const cv::Mat truth = disc({160, 90}, 30);
  const cv::Mat grey = picture(truth, 60, 120);
  for (const cv::Mat& blurred : {disc({160, 90}, 40), disc({165, 95}, 38), disc({160, 90}, 24)}) {
    ASSERT_LT(overlap(blurred, truth), 0.68);
    cv::Mat mask = blurred.clone();
    moveBordersToEdges(mask, grey, kReach);
    EXPECT_GT(overlap(mask, truth), 0.95);
  }
}

TEST(MaskBorders, WithTextureButWithoutEdgesTheCoreStays) {
  const cv::Mat flow = disc({160, 90}, 40);
  cv::Mat mask = flow.clone(), grey = picture(flow, 100, 100);
  addDots(grey, 40, cv::Mat(kSize, CV_8UC1, cv::Scalar(255)));
  moveBordersToEdges(mask, grey, kReach);
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
  moveBordersToEdges(mask, grey, kReach);
  EXPECT_GT(overlap(mask, car), 0.85);
  moveBordersToEdges(kept, with_pattern_on_road, kReach);
  EXPECT_GT(cv::countNonZero(kept(cv::Rect(170, 85, 15, 20))), 250);  // of 300
}

TEST(MaskBorders, WhatIsSmallIsKept) {
  const cv::Mat truth = disc({100, 50}, 3);
  cv::Mat mask = disc({100, 50}, 5);
  moveBordersToEdges(mask, picture(truth, 40, 120), kReach);
  EXPECT_GT(overlap(mask, truth), 0.8);
}

TEST(MaskBorders, RegionsFarApartDoNotTouchEachOther) {
  const cv::Mat left = disc({50, 90}, 20), right = disc({270, 60}, 25);
  const cv::Mat grey = picture(left | right, 60, 120);
  cv::Mat alone = disc({50, 90}, 26), both = alone | disc({270, 60}, 33);
  moveBordersToEdges(alone, grey, kReach);
  moveBordersToEdges(both, grey, kReach);
  EXPECT_EQ(cv::norm(both.colRange(0, 160), alone.colRange(0, 160), cv::NORM_INF), 0.0);
  EXPECT_GT(overlap(both, left | right), 0.97);
}

TEST(MaskBorders, NothingAndEverythingStay) {
  const cv::Mat grey = picture(disc({160, 90}, 30), 60, 120);
  cv::Mat nothing = cv::Mat::zeros(kSize, CV_8UC1), everything(kSize, CV_8UC1, cv::Scalar(255));
  moveBordersToEdges(nothing, grey, kReach);
  moveBordersToEdges(everything, grey, kReach);
  EXPECT_EQ(cv::countNonZero(nothing), 0);
  EXPECT_EQ(cv::countNonZero(everything), kSize.area());
}

// A square that moves 6 px to the right before a wall that stands; its flow reaches 8 px over its border.
TEST(MaskBorders, AreMovedByTheSegmenterWhereThereIsAnImage) {
  const cv::Rect square(140, 70, 40, 40);
  MotionInput input;
  input.camera = CameraIntrinsics{200.0, 200.0, 159.5, 89.5, kSize.width, kSize.height};
  input.depth = cv::Mat(kSize, CV_32FC1, cv::Scalar(20.0));
  input.flow = cv::Mat(kSize, CV_32FC2, cv::Scalar::all(0.0));
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
