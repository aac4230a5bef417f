// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/static_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "fixtures/camera_mount.h"

namespace radar_dot {
namespace {

constexpr int kColumns = 101, kRows = 81;

cv::Mat marked(const cv::Rect& area) {
  cv::Mat mask = cv::Mat::zeros(kRows, kColumns, CV_8UC1);
  mask(area).setTo(255);
  return mask;
}

cv::Mat keepMask(const cv::Mat& mask, const cv::Size& size, double dilation) {
  return distanceToMoving(mask, size) > dilation;
}

/// Whether two images differ nowhere.
bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(DistanceToMoving, KeepsAllWhereNothingMoves) {
  const cv::Mat keep = keepMask(marked({0, 0, 0, 0}), {kColumns, kRows}, 50.0);
  EXPECT_EQ(keep.type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(keep == 255), kColumns * kRows);
}

TEST(DistanceToMoving, DropsADiscAroundAPixel) {
  for (const double radius : {0.0, 1.0, 2.0, 2.5, 7.0}) {
    const cv::Mat keep = keepMask(marked({50, 40, 1, 1}), {kColumns, kRows}, radius);
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column)
        ASSERT_EQ(keep.at<std::uint8_t>(row, column), std::hypot(row - 40, column - 50) <= radius ? 0 : 255)
            << radius << ' ' << row << ' ' << column;
  }
}

TEST(DistanceToMoving, AMaskOnACoarserGridCoversTheSamePartOfTheImage) {
  cv::Mat mask = cv::Mat::zeros(9, 16, CV_8UC1);
  mask.at<std::uint8_t>(3, 5) = 1;
  const cv::Mat keep = keepMask(mask, {64, 36}, 0.0);
  cv::Mat expected(36, 64, CV_8UC1, cv::Scalar(255));
  expected(cv::Rect(20, 12, 4, 4)).setTo(0);
  EXPECT_TRUE(same(keep, expected));
}

TEST(DistanceToMoving, DropsAllWhereAllMoves) {
  EXPECT_EQ(cv::countNonZero(keepMask(marked({0, 0, kColumns, kRows}), {kColumns, kRows}, 3.0)), 0);
}

TEST(Filled, WhatIsKeptStaysAsItIs) {
  cv::Mat image(kRows, kColumns, CV_8UC3);
  cv::randu(image, 0, 256);
  const cv::Mat moves = marked({30, 20, 40, 50});
  const cv::Mat before = image.clone(), result = filled(image, moves == 0);
  EXPECT_TRUE(same(image, before)) << "the input is not written to";
  cv::Mat left = result.clone(), right = before.clone();
  left.setTo(0, moves);
  right.setTo(0, moves);
  EXPECT_TRUE(same(left, right));
  EXPECT_TRUE(same(filled(image, moves >= 0), image)) << "nothing moves";
}

TEST(Filled, AnEvenWallGoesOnBehindWhatMoves) {
  for (const cv::Rect& area : {cv::Rect(50, 40, 1, 1), cv::Rect(30, 20, 40, 50), cv::Rect(0, 0, 60, 81)}) {
    cv::Mat wall(kRows, kColumns, CV_8UC3, cv::Scalar(17, 101, 253));
    cv::Mat image = wall.clone(), grey(kRows, kColumns, CV_8UC1, cv::Scalar(101));
    const cv::Mat even = grey.clone();
    image(area).setTo(cv::Scalar(255, 0, 0));
    grey(area).setTo(255);
    EXPECT_TRUE(same(filled(image, marked(area) == 0), wall)) << area;
    EXPECT_TRUE(same(filled(grey, marked(area) == 0), even)) << area;
  }
}

// From 60 on the left to 160 on the right: nothing in between leaves that range, and no step is as large as
// one of what moved, 200.
TEST(Filled, HasNoEdges) {
  cv::Mat image(kRows, kColumns, CV_8UC1);
  for (int column = 0; column < kColumns; ++column) image.col(column).setTo(60 + column);
  image(cv::Rect(30, 20, 40, 40)).setTo(0);
  const cv::Mat result = filled(image, marked({30, 20, 40, 40}) == 0);
  cv::Mat step;
  cv::absdiff(result.colRange(1, kColumns), result.colRange(0, kColumns - 1), step);
  double smallest = 0.0, largest = 0.0, edge = 0.0;
  cv::minMaxLoc(result, &smallest, &largest);
  cv::minMaxLoc(step, nullptr, &edge);
  EXPECT_GE(smallest, 60.0);
  EXPECT_LE(largest, 160.0);
  EXPECT_LE(edge, 12.0);
}

TEST(Filled, WithoutAnythingKeptItIsBlack) {
  const cv::Mat image(kRows, kColumns, CV_8UC3, cv::Scalar(9, 9, 9));
  EXPECT_TRUE(
      same(filled(image, cv::Mat::zeros(kRows, kColumns, CV_8UC1)), cv::Mat::zeros(image.size(), CV_8UC3)));
}

// A camera at the origin that looks along x: at 8 m there are 8 px to the metre.
TEST(KeptPoints, ThoseOnWhatMovesGo) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const CameraIntrinsics camera{64.0, 64.0, 50.0, 40.0, kColumns, kRows};
  const Eigen::Isometry3d mount = test::lookingAhead().inverse();
  const cv::Mat keep = marked({34, 32, 1, 1}) == 0;
  const std::vector<Eigen::Vector3f> points = {{8.F, 2.F, 1.F},      // 16 px to the left, 8 px up: there
                                               {16.F, 4.F, 2.F},     // behind it on the same ray
                                               {8.F, 2.05F, 1.05F},  // 0.4 px farther: the same pixel
                                               {8.F, 2.1F, 1.F},     // 0.8 px farther: the next one
                                               {8.F, -2.F, 1.F},     // on the other side
                                               {-8.F, -2.F, -1.F},   // behind the camera, on the same line
                                               {0.05F, 0.0125F, 0.00625F},  // too near to tell
                                               {8.F, 40.F, 0.F},            // out of the view
                                               {kNaN, 2.F, 1.F},
                                               {8.F, 2.F, std::numeric_limits<float>::infinity()}};
  EXPECT_EQ(keptPoints(points, keep, camera, mount),
            (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1, 1, 1, 1, 1}));
  // The first pixel reaches half a pixel beyond its centre: 50.4 px to the left of the middle, 40.4 px up.
  EXPECT_EQ(keptPoints({{8.F, 6.3F, 5.05F}}, marked({0, 0, 1, 1}) == 0, camera, mount).at(0), 0);
}

}  // namespace
}  // namespace radar_dot
