// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/mask_footprint.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fixtures/camera_mount.h"
#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr int kColumns = 101, kRows = 81;

CameraIntrinsics camera() { return {64.0, 64.0, 50.0, 40.0, kColumns, kRows}; }

/// T_camera_from_base, at the origin of the base frame.
Eigen::Isometry3d mount() { return test::lookingAhead().inverse(); }

/// At 8 m there are 8 px to the metre: rows 29 (top) to 38 (bottom), ten of them.
MaskFootprint tenPixels() {
  MaskFootprint footprint;
  footprint.bottom = 0.25;
  footprint.top = 1.375;
  return footprint;
}

cv::Mat marked(const cv::Rect& area) {
  cv::Mat mask = cv::Mat::zeros(kRows, kColumns, CV_8UC1);
  mask(area).setTo(255);
  return mask;
}

int isIn(const Eigen::Vector3f& point, const cv::Mat& mask, const MaskFootprint& footprint = tenPixels()) {
  return pointsInMask({point}, {0.0, mask, camera(), mount()}, footprint).at(0);
}

TEST(MaskFootprint, TheColumnOfAPointIsWhereItProjects) {
  // 2 m to the left at 8 m: 16 px to the left of the centre.
  const Eigen::Vector3f left(8.0F, 2.0F, 0.0F);
  EXPECT_EQ(isIn(left, marked({34, 29, 1, 10})), 1);
  EXPECT_EQ(isIn(left, marked({33, 29, 1, 10})), 0);
  EXPECT_EQ(isIn(left, marked({35, 29, 1, 10})), 0);
  EXPECT_EQ(isIn(left, marked({66, 29, 1, 10})), 0);  // as far to the right
  EXPECT_EQ(isIn(left, marked({34, 0, 1, 29})), 0);   // above the column
  EXPECT_EQ(isIn(left, marked({34, 39, 1, 42})), 0);  // below it
  EXPECT_EQ(isIn(left, marked({0, 0, 0, 0})), 0);
}

// Radar does not know the height of a return: the column stands at its place, whatever z says.
TEST(MaskFootprint, TheHeightOfThePointDoesNotMatter) {
  EXPECT_EQ(isIn({8.0F, 0.0F, 30.0F}, marked({50, 29, 1, 10})), 1);
}

TEST(MaskFootprint, TheMountIsApplied) {
  Eigen::Isometry3d T_base_from_camera = mount().inverse();
  T_base_from_camera.translation() = Eigen::Vector3d(-8.0, 0.0, 0.0);  // 16 m away, 4 px to the metre
  MaskFootprint footprint;
  footprint.bottom = 0.25;
  footprint.top = 1.25;
  const StampedMask mask{0.0, marked({42, 35, 1, 5}), camera(), T_base_from_camera.inverse()};
  EXPECT_EQ(pointsInMask({{8.0F, 2.0F, 0.0F}}, mask, footprint).at(0), 1);
}

TEST(MaskFootprint, HalfOfTheColumnDecides) {
  const Eigen::Vector3f ahead(8.0F, 0.0F, 0.0F);
  EXPECT_EQ(isIn(ahead, marked({50, 29, 1, 5})), 1);  // 5 of 10: the share itself is enough
  EXPECT_EQ(isIn(ahead, marked({50, 29, 1, 4})), 0);
  MaskFootprint all = tenPixels();
  all.min_fraction = 1.0;
  EXPECT_EQ(isIn(ahead, marked({50, 29, 1, 9}), all), 0);
  EXPECT_EQ(isIn(ahead, marked({50, 29, 1, 10}), all), 1);
}

// At 2 m there are 32 px to the metre: rows -4 to 32, of which 33 are in the image.
TEST(MaskFootprint, OnlyVisiblePixelsCount) {
  const Eigen::Vector3f near(2.0F, 0.0F, 0.0F);
  EXPECT_EQ(isIn(near, marked({50, 0, 1, 17})), 1);
  EXPECT_EQ(isIn(near, marked({50, 0, 1, 16})), 0);
}

TEST(MaskFootprint, WhatTheCameraDoesNotSeeIsNotInTheMask) {
  const StampedMask everything{0.0, cv::Mat(kRows, kColumns, CV_8UC1, cv::Scalar(255)), camera(), mount()};
  const std::vector<Eigen::Vector3f> points = {
      {8.0F, 0.0F, 0.0F},    // ahead
      {-8.0F, 0.0F, 0.0F},   // behind
      {0.0F, 0.0F, 0.0F},    // at the camera
      {8.0F, 6.5F, 0.0F},    // 52 px to the left: column -2
      {8.0F, -6.5F, 0.0F},   // column 102
      {0.125F, 0.0F, 0.0F},  // its column begins far above the image
      {kNaN, 0.0F, 0.0F},    //
      {8.0F, kNaN, 0.0F},    //
      {8.0F, 0.0F, kNaN},    // a point that is not finite is none, also in z
      {0.2F, 100.0F, 0.0F},  // so far to the side that the walk along it would be long
      {8.0F, 6.25F, 0.0F},   // column 0
      {8.0F, -6.25F, 0.0F},  // column 100
  };
  EXPECT_EQ(pointsInMask(points, everything, tenPixels()),
            (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1}));
  EXPECT_TRUE(pointsInMask({}, everything).empty());
}

TEST(MaskFootprint, AnyValueButZeroIsMarked) {
  EXPECT_EQ(isIn({8.0F, 0.0F, 0.0F}, marked({50, 29, 1, 10}) / 255), 1);
}

TEST(MaskFootprint, RefusesMasksOfAnotherTypeOrSize) {
  const auto expect = [](const cv::Mat& mask) {
    test::expectRefusal([&mask] { pointsInMask({}, {0.0, mask, camera(), mount()}); }, {"mask", "101 x 81"});
  };
  expect(cv::Mat::zeros(kRows, kColumns, CV_32FC1));
  expect(cv::Mat::zeros(kRows, kColumns, CV_8UC3));
  expect(cv::Mat::zeros(kRows, kColumns - 1, CV_8UC1));
  expect(cv::Mat::zeros(kRows + 1, kColumns, CV_8UC1));
  expect(cv::Mat());
}

}  // namespace
}  // namespace radar_dot
