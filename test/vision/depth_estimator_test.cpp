// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/depth_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fixtures/camera_mount.h"
#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

const CameraIntrinsics kCamera{400.0, 400.0, 200.0, 100.0, 401, 301};

/// 1.5 m above the base frame's origin, 1 m ahead of it.
Eigen::Isometry3d mount() { return test::lookingAhead({1.0, 0.0, 1.5}); }

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
  params.radar_ground.background_depth = 0.0;
  params.radar_ground.column_height = 3.5;
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
  DepthParams params;
  params.radar_ground.background_depth = 60.0;
  params.radar_ground.background_angle = 0.06;
  const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
  EXPECT_NEAR(depth.at<float>(5, 20), 60.0, 0.5);
  EXPECT_NEAR(depth.at<float>(106, 20), 60.0, 0.5);   // ground at 100 m is behind it
  EXPECT_NEAR(depth.at<float>(112, 20), 50.0, 1e-3);  // ground at 50 m is before it
  EXPECT_LT(depth.at<float>(5, 360), 15.0);
  EXPECT_GT(depth.at<float>(5, 360), 10.0);
}

// A bright box, narrower on the left and higher than the column expected: 36 px wide and 32 px high.
TEST(RadarGround, ColumnsEndAtEdgesOfTheImage) {
  DepthInput in = input();
  in.radar_points = {{21.0F, 0.0F, 0.0F}};
  in.image = cv::Mat(kCamera.height, kCamera.width, CV_8UC3, cv::Scalar::all(60));
  in.image(cv::Rect(cv::Point(190, 90), cv::Point(218, 131))).setTo(cv::Scalar::all(200));
  DepthParams params;
  params.radar_ground.background_depth = 0.0;
  const auto known = [&](int v, int u) {
    return makeDepthEstimator(params)->estimate(in).at<float>(v, u) == 20.0F;
  };
  EXPECT_TRUE(known(105, 184));
  EXPECT_FALSE(known(92, 200));
  params.radar_ground.image_edges = true;
  EXPECT_FALSE(known(105, 186));
  EXPECT_TRUE(known(105, 193));
  EXPECT_TRUE(known(105, 215));
  EXPECT_FALSE(known(105, 222));
  EXPECT_TRUE(known(92, 200));
  EXPECT_FALSE(known(86, 200));
  in.image = cv::Mat();  // nothing to move to
  EXPECT_TRUE(known(105, 184));
  in.image = cv::Mat(3, 3, CV_32FC1, cv::Scalar(0.0));
  EXPECT_THROW(known(105, 184), std::invalid_argument);
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
      in.lidar_points.emplace_back((mount() * (d * kCamera.rayOf(u, v))).cast<float>());
    }
  }
  DepthParams params;
  params.backend = "lidar";
  const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
  EXPECT_NEAR(depth.at<float>(103, 103), 25.0, 0.01);
  EXPECT_NEAR(depth.at<float>(103, 211), 10.0, 0.01);
  EXPECT_TRUE(std::isnan(depth.at<float>(20, 200)));
}

/// Points of a 32-beam lidar on a wall: beams 1.33 degrees apart, points 0.33 degrees.
std::vector<Eigen::Vector3f> sweepOfWall(double distance) {
  std::vector<Eigen::Vector3f> points;
  for (int beam = -10; beam <= 4; ++beam) {
    for (int step = -60; step <= 60; ++step) {
      const double azimuth = step * 0.33 * 0.0174533;
      const double y = distance * std::tan(azimuth);
      const double z = 1.5 + std::hypot(distance, y) * std::tan(beam * 1.33 * 0.0174533);
      points.emplace_back(Eigen::Vector3d(1.0 + distance, y, z).cast<float>());
    }
  }
  return points;
}

// Defaults close the gaps between the beams of a common lidar, at every width of the grid.
TEST(LidarDepth, DefaultsCloseTheGapsBetweenBeams) {
  for (const int width : {640, 800, 1600}) {
    DepthInput in = input();
    in.camera = CameraIntrinsics{1266.0, 1266.0, 800.0, 450.0, 1600, 900}.scaledTo(width, width * 9 / 16);
    in.lidar_points = sweepOfWall(20.0);
    DepthParams params;
    params.backend = "lidar";
    const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
    const cv::Rect inside(width * 3 / 8, width / 4, width / 4, width / 8);
    double nearest = 0.0, farthest = 0.0;
    EXPECT_EQ(cv::countNonZero(depth(inside) == depth(inside)), inside.area()) << width;
    cv::minMaxLoc(depth(inside), &nearest, &farthest);
    EXPECT_NEAR(nearest, 20.0, 0.01) << width;
    EXPECT_NEAR(farthest, 20.0, 0.01) << width;
    EXPECT_EQ(cv::countNonZero(depth.rowRange(0, width / 8) == depth.rowRange(0, width / 8)), 0) << width;
  }
}

// A slanted plane is linear in inverse depth, so that what is between the points is exact.
TEST(LidarDepth, RoadsStayFlat) {
  DepthInput in = input();
  for (int v = 140; v <= 300; v += 8)
    for (int u = 0; u <= 400; u += 2)
      in.lidar_points.emplace_back((mount() * (600.0 / (v - 100) * kCamera.rayOf(u, v))).cast<float>());
  DepthParams params;
  params.backend = "lidar";
  const cv::Mat depth = makeDepthEstimator(params)->estimate(in);
  for (const int v : {160, 175, 190, 230, 270}) {
    const double truth = 600.0 / (v - 100);
    EXPECT_NEAR(depth.at<float>(v, 200), truth, 0.03 * truth) << v;
  }
}

TEST(LidarDepth, WideGapsStayOpen) {
  DepthInput in = input();
  for (int u = 0; u <= 400; u += 2) {
    in.lidar_points.emplace_back((mount() * (10.0 * kCamera.rayOf(u, 100))).cast<float>());
    in.lidar_points.emplace_back((mount() * (10.0 * kCamera.rayOf(u, 160))).cast<float>());
  }
  DepthParams params;
  params.backend = "lidar";
  EXPECT_TRUE(std::isnan(makeDepthEstimator(params)->estimate(in).at<float>(130, 200)));
  params.lidar.completion_kernel = 199;  // 49 px here
  EXPECT_TRUE(std::isnan(makeDepthEstimator(params)->estimate(in).at<float>(130, 200)));
}

TEST(DepthEstimator, BackendsPlugInByName) {
  struct Wall : DepthEstimator {
    cv::Mat estimate(const DepthInput& input) override {
      return cv::Mat(input.camera.height, input.camera.width, CV_32FC1, cv::Scalar(8.0));
    }
    DepthNeeds needs() const override { return {}; }
  };
  registerDepthEstimator("wall", [](const DepthParams&) { return std::make_unique<Wall>(); });
  DepthParams params;
  params.backend = "wall";
  EXPECT_FLOAT_EQ(makeDepthEstimator(params)->estimate(input()).at<float>(5, 5), 8.0F);
  EXPECT_EQ(depthBackends(), (std::vector<std::string>{"lidar", "motion", "radar_ground", "wall"}));
  EXPECT_THROW(registerDepthEstimator("", [](const DepthParams&) { return std::make_unique<Wall>(); }),
               std::invalid_argument);
}

TEST(DepthEstimator, SaysWhatItLooksAt) {
  DepthParams params;
  EXPECT_TRUE(makeDepthEstimator(params)->needs().radar);
  EXPECT_FALSE(makeDepthEstimator(params)->needs().image);
  params.radar_ground.image_edges = true;
  EXPECT_TRUE(makeDepthEstimator(params)->needs().image);
  params.backend = "lidar";
  EXPECT_TRUE(makeDepthEstimator(params)->needs().lidar);
  EXPECT_FALSE(makeDepthEstimator(params)->needs().radar);
}

TEST(DepthEstimator, RefusalsSayWhatIsWrong) {
  const auto expect = [](const DepthParams& params, const char* part) {
    test::expectRefusal([&params] { makeDepthEstimator(params)->estimate(input()); }, {part});
  };
  DepthParams params;
  params.backend = "stereo";
  expect(params, "radar_ground");
  params = {};
  params.radar_ground.column_height = -1.0;
  expect(params, "column_height");
  params = {};
  params.backend = "lidar";
  expect(params, "no lidar points");
}

}  // namespace
}  // namespace radar_dot
