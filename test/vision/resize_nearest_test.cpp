// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/resize_nearest.h"

#include <gtest/gtest.h>

#include <vector>

namespace radar_dot {
namespace {

std::vector<float> row(const std::vector<float>& values, int width) {
  const cv::Mat resized = resizeNearest(cv::Mat(values, true).t(), {width, 3});
  EXPECT_EQ(resized.rows, 3);
  return {resized.ptr<float>(2), resized.ptr<float>(2) + width};
}

TEST(ResizeNearest, TakesThePixelUnderTheCentre) {
  EXPECT_EQ(row({0, 1, 2, 3, 4, 5}, 2), (std::vector<float>{1, 4}));
  EXPECT_EQ(row({0, 1, 2, 3, 4}, 2), (std::vector<float>{1, 3}));
  EXPECT_EQ(row({0, 1}, 6), (std::vector<float>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(row({7}, 5), (std::vector<float>(5, 7)));
}

TEST(ResizeNearest, ABorderBetweenTwoPixelsGoesToTheFirst) {
  EXPECT_EQ(row({0, 1, 2, 3}, 2), (std::vector<float>{0, 2}));
}

TEST(ResizeNearest, KeepsWhatNeedsNoChange) {
  const cv::Mat image(2, 3, CV_8UC1, cv::Scalar(4));
  EXPECT_EQ(resizeNearest(image, {3, 2}).data, image.data);
  EXPECT_TRUE(resizeNearest(cv::Mat(), {3, 2}).empty());
}

}  // namespace
}  // namespace radar_dot
