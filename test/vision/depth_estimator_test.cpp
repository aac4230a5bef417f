// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/depth_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace radar_dot {
namespace {

const CameraIntrinsics kCamera{400.0, 400.0, 200.0, 100.0, 401, 301};

/// 1.5 m above the base frame's origin, 1 m ahead of it, looking ahead.
Eigen::Isometry3d mount() {
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
  T_base_from_camera.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  T_base_from_camera.translation() = Eigen::Vector3d(1.0, 0.0, 1.5);
  return T_base_from_camera;
}

DepthInput input() {
  DepthInput in;
  in.camera = kCamera;
  in.T_base_from_camera = mount();
  return in;
}

// A level camera at height h sees the ground at depth f h / (v - cy).
TEST(GroundDepth, LevelCamera) {
  const cv::Mat depth = groundDepth(kCamera, mount(), 0.0, 0.0, 120.0);
  EXPECT_NEAR(depth.at<float>(160, 200), 10.0, 1e-4);
  EXPECT_NEAR(depth.at<float>(160, 17), 10.0, 1e-4);
  EXPECT_NEAR(depth.at<float>(300, 200), 3.0, 1e-4);
  EXPECT_TRUE(std::isnan(depth.at<float>(100, 200)));  // the horizon
  EXPECT_TRUE(std::isnan(depth.at<float>(20, 200)));
  EXPECT_TRUE(std::isnan(depth.at<float>(104, 200)));  // 150 m
}

// With the nose down the ground rises ahead: z = 0.1 x meets the ray z = 1.5 - 0.15 (x - 1) at 1.4 / 0.25.
TEST(GroundDepth, NoseDown) {
  const cv::Mat depth = groundDepth(kCamera, mount(), 0.0, std::atan(0.1), 120.0);
  EXPECT_NEAR(depth.at<float>(160, 200), 1.4 / 0.25, 1e-4);
}

TEST(RadarGround, ReturnsStandUpright) {
  DepthInput in = input();
  in.radar_points = {{21.0F, 0.0F, 9.0F}, {11.0F, -4.0F, 0.5F}};  // 20 m and 10 m before the camera
  DepthParams params;
  params.background_depth = 0.0;
  const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
  EXPECT_FLOAT_EQ(depth.at<float>(100, 200), 20.0F);
  EXPECT_FLOAT_EQ(depth.at<float>(130, 200), 20.0F);           // its foot
  EXPECT_NEAR(depth.at<float>(135, 200), 600.0 / 35.0, 1e-3);  // the ground before it
  EXPECT_FLOAT_EQ(depth.at<float>(100, 360), 10.0F);           // 4 m to the right
  EXPECT_TRUE(std::isnan(depth.at<float>(100, 280)));          // between the two
  EXPECT_TRUE(std::isnan(depth.at<float>(50, 200)));           // above 3.5 m: v = 100 - 400 * 2 / 20
}

TEST(RadarGround, NearerColumnsHideFartherOnes) {
  for (const bool near_first : {true, false}) {
    DepthInput in = input();
    in.radar_points = {{21.0F, 0.0F, 0.0F}, {41.0F, 0.0F, 0.0F}};
    if (!near_first) std::swap(in.radar_points[0], in.radar_points[1]);
    EXPECT_FLOAT_EQ(makeDepthEstimator()->estimate(in).at<float>(100, 200), 20.0F);
  }
}

TEST(RadarGround, BackgroundComesNearerWhereRadarSeesSomething) {
  DepthInput in = input();
  in.radar_points = {{11.0F, -4.0F, 0.5F}};
  const cv::Mat depth = makeDepthEstimator()->estimate(in);
  EXPECT_NEAR(depth.at<float>(5, 20), 60.0, 0.5);
  EXPECT_LT(depth.at<float>(5, 360), 15.0);
  EXPECT_GT(depth.at<float>(5, 360), 10.0);
}

TEST(RadarGround, BadReturnsAreLeftOut) {
  DepthInput in = input();
  const cv::Mat without = makeDepthEstimator()->estimate(in);
  in.radar_points = {{std::nanf(""), 0.0F, 0.0F}, {-20.0F, 0.0F, 0.0F}, {900.0F, 0.0F, 0.0F}};
  const cv::Mat with = makeDepthEstimator()->estimate(in);
  EXPECT_EQ(cv::norm(without, with, cv::NORM_INF), 0.0);
}

TEST(ProjectedDepth, TheNearestPointWins) {
  const cv::Mat depth =
      projectedDepth({{21.0F, 0.0F, 1.5F}, {11.0F, 0.0F, 1.5F}, {31.0F, 0.0F, 1.5F}, {-9.0F, 0.0F, 1.5F}},
                     kCamera, mount(), 120.0);
  EXPECT_FLOAT_EQ(depth.at<float>(100, 200), 10.0F);
  int known = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) known += std::isnan(depth.at<float>(v, u)) ? 0 : 1;
  EXPECT_EQ(known, 1);
}

// A wall of points, 7 px apart, with a nearer post before it.
TEST(LidarDepth, ClosesGapsAndLeavesTheSkyOpen) {
  DepthInput in = input();
  for (int v = 60; v <= 240; v += 7) {
    for (int u = 20; u <= 380; u += 7) {
      const double d = u > 190 && u < 230 ? 10.0 : 25.0;
      in.lidar_points.push_back((mount() * (d * kCamera.rayOf(u, v))).cast<float>());
    }
  }
  DepthParams params;
  params.backend = "lidar";
  params.completion_kernel = 60;
  const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
  EXPECT_NEAR(depth.at<float>(103, 103), 25.0, 0.01);
  EXPECT_NEAR(depth.at<float>(103, 211), 10.0, 0.01);
  EXPECT_TRUE(std::isnan(depth.at<float>(20, 200)));
}

TEST(DepthEstimator, RefusalsSayWhatIsWrong) {
  const auto expect = [](const DepthParams& params, const char* part) {
    try {
      makeDepthEstimator(params)->estimate(input());
      FAIL() << part;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  DepthParams params;
  params.backend = "stereo";
  expect(params, "radar_ground");
  params = {};
  params.column_height = -1.0;
  expect(params, "column_height");
  params = {};
  params.backend = "lidar";
  expect(params, "no lidar points");
}

}  // namespace
}  // namespace radar_dot
