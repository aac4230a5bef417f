// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/just_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fixtures/camera_mount.h"
#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

using just_depth::kCut;
using just_depth::kHeight;
using just_depth::kRows;
using just_depth::kWidth;

// Planes one below the other: red, green, blue.
float valueOf(const cv::Mat& planes, int channel, int row, int column) {
  return planes.at<float>(channel * kRows + row, column);
}

TEST(JustDepthImage, IsNormalisedByHand) {
  cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar(10, 20, 30));  // blue, green, red
  image.at<cv::Vec3b>(kCut, 7) = cv::Vec3b(255, 0, 128);
  cv::Mat planes;
  just_depth::imagePlanes(image, planes);
  ASSERT_EQ(planes.size(), cv::Size(1600, 3 * 896));
  ASSERT_EQ(planes.type(), CV_32FC1);
  EXPECT_NEAR(valueOf(planes, 0, 500, 900), (30.0 / 255.0 - 0.485) / 0.229, 1e-5);  // -1.60416
  EXPECT_NEAR(valueOf(planes, 0, 500, 900), -1.60416F, 1e-4F);
  EXPECT_NEAR(valueOf(planes, 1, 500, 900), -1.68557F, 1e-4F);  // (20 / 255 - 0.456) / 0.224
  EXPECT_NEAR(valueOf(planes, 2, 500, 900), -1.63015F, 1e-4F);  // (10 / 255 - 0.406) / 0.225
  // The first row that is left is the fifth of the image.
  EXPECT_NEAR(valueOf(planes, 0, 0, 7), 0.07406F, 1e-4F);   // (128 / 255 - 0.485) / 0.229
  EXPECT_NEAR(valueOf(planes, 1, 0, 7), -2.03571F, 1e-4F);  // -0.456 / 0.224
  EXPECT_NEAR(valueOf(planes, 2, 0, 7), 2.64F, 1e-4F);      // (1 - 0.406) / 0.225
}

TEST(JustDepthImage, MayBeGreyOrOfAnotherSize) {
  cv::Mat planes;
  just_depth::imagePlanes(cv::Mat(450, 800, CV_8UC1, cv::Scalar(255)), planes);
  ASSERT_EQ(planes.size(), cv::Size(1600, 3 * 896));
  EXPECT_NEAR(valueOf(planes, 0, 895, 1599), 2.24891F, 1e-4F);  // (1 - 0.485) / 0.229
  EXPECT_NEAR(valueOf(planes, 2, 0, 0), 2.64F, 1e-4F);
  test::expectRefusal([&] { just_depth::imagePlanes({}, planes); }, {"image"});
  test::expectRefusal([&] { just_depth::imagePlanes(cv::Mat(900, 1600, CV_16UC1), planes); }, {"CV_8UC3"});
}

class JustDepthRadar : public testing::Test {
 protected:
  std::vector<float> columnsOf(const std::vector<Eigen::Vector3f>& points) const {
    return just_depth::radarColumns(points, camera_, T_base_from_camera_);
  }
  static std::ptrdiff_t filled(const std::vector<float>& columns) {
    return std::count_if(columns.begin(), columns.end(), [](float depth) { return depth != 0.0F; });
  }

  CameraIntrinsics camera_{1000.0, 1000.0, 800.0, 450.0, kWidth, kHeight};
  const Eigen::Isometry3d T_base_from_camera_ = test::lookingAhead({1.5, 0.0, 1.5});
};

TEST_F(JustDepthRadar, NearestReturnOfAColumnCounts) {
  // 20 m before the camera, 2 m to the left: u = 1000 * -2 / 20 + 800 = 700. 10 m, 1 m: the same column.
  const std::vector<float> far_first = columnsOf({{21.5F, 2.0F, 0.5F}, {11.5F, 1.0F, 0.5F}});
  EXPECT_FLOAT_EQ(far_first[700], 10.0F);
  EXPECT_EQ(filled(far_first), 1);
  const std::vector<float> near_first = columnsOf({{11.5F, 1.0F, 0.5F}, {21.5F, 2.0F, 0.5F}});
  EXPECT_FLOAT_EQ(near_first[700], 10.0F);
  // 3.001 m to the right at 20 m: u = 950.05.
  EXPECT_FLOAT_EQ(columnsOf({{21.5F, -3.001F, 0.5F}})[950], 20.0F);
}

TEST_F(JustDepthRadar, ReturnsOutsideTheImageDoNotCount) {
  EXPECT_EQ(filled(columnsOf({{-10.0F, 0.0F, 0.5F}})), 0);   // behind
  EXPECT_EQ(filled(columnsOf({{21.5F, 16.0F, 0.5F}})), 0);   // u = 0: not inside
  EXPECT_EQ(filled(columnsOf({{21.5F, 15.99F, 0.5F}})), 1);  // u = 0.5
  EXPECT_EQ(filled(columnsOf({{21.5F, -16.0F, 0.5F}})), 0);  // u = 1600
  EXPECT_EQ(filled(columnsOf({{21.5F, 0.0F, 10.6F}})), 0);   // v = -5
  EXPECT_EQ(filled(columnsOf({{4.5F, 0.0F, 0.1F}})), 0);     // v = 916, below the image
  EXPECT_EQ(filled(columnsOf({{21.5F, 0.0F, 10.49F}})), 1);  // v = 0.5: in a row that is cut
  EXPECT_EQ(filled(columnsOf({{std::nanf(""), 0.0F, 0.5F}})), 0);
}

TEST_F(JustDepthRadar, TheGridOfTheCameraDoesNotMatter) {
  const std::vector<Eigen::Vector3f> points = {{21.5F, 2.0005F, 0.5F}, {31.5F, -4.0F, 1.0F}};
  const std::vector<float> full = columnsOf(points);
  const std::vector<float> half =
      just_depth::radarColumns(points, camera_.scaledTo(800, 450), T_base_from_camera_);
  EXPECT_EQ(filled(full), 2);
  EXPECT_EQ(full, half);
}

TEST(JustDepthOutput, CutRowsAreUnknownAndNothingIsNegative) {
  cv::Mat output(kRows, kWidth, CV_32FC1, cv::Scalar(30.0));
  output.at<float>(0, 0) = 5.0F;
  output.at<float>(1, 1) = -3.0F;
  output.at<float>(2, 2) = std::numeric_limits<float>::infinity();
  const cv::Mat full = just_depth::onGrid(output, {kWidth, kHeight});
  ASSERT_EQ(full.size(), cv::Size(kWidth, kHeight));
  for (int row = 0; row < kCut; ++row) EXPECT_TRUE(std::isnan(full.at<float>(row, 800)));
  EXPECT_FLOAT_EQ(full.at<float>(kCut, 0), 5.0F);
  EXPECT_FLOAT_EQ(full.at<float>(kCut + 1, 1), 0.0F);
  EXPECT_TRUE(std::isnan(full.at<float>(kCut + 2, 2)));
  EXPECT_FLOAT_EQ(full.at<float>(kHeight - 1, kWidth - 1), 30.0F);
}

TEST(JustDepthOutput, StaysWhereItIsOnASmallerGrid) {
  cv::Mat output(kRows, kWidth, CV_32FC1, cv::Scalar(30.0));
  output(cv::Rect(400, 200 - kCut, 100, 60)).setTo(7.0F);  // rows 200 to 259 of the full image
  const cv::Mat half = just_depth::onGrid(output, {800, 450});
  EXPECT_TRUE(std::isnan(half.at<float>(1, 400)));
  EXPECT_FLOAT_EQ(half.at<float>(2, 400), 30.0F);
  EXPECT_FLOAT_EQ(half.at<float>(99, 225), 30.0F);
  EXPECT_FLOAT_EQ(half.at<float>(100, 200), 7.0F);
  EXPECT_FLOAT_EQ(half.at<float>(129, 249), 7.0F);
  EXPECT_FLOAT_EQ(half.at<float>(130, 250), 30.0F);
  test::expectRefusal([] { just_depth::onGrid(cv::Mat(900, 1600, CV_32FC1), {800, 450}); }, {"896"});
}

}  // namespace
}  // namespace radar_dot
