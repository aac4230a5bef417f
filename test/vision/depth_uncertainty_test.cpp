// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What depth says of its own uncertainty.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "fixtures/camera_mount.h"
#include "fixtures/refusal.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/motion_refinement.h"

namespace radar_dot {
namespace {

const CameraIntrinsics kCamera{400.0, 400.0, 200.0, 100.0, 401, 301};
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// 1.5 m above the base frame's origin, 1 m ahead of it.
Eigen::Isometry3d mount() { return test::lookingAhead({1.0, 0.0, 1.5}); }

/// The same, rolled, nose down, and turned to the side.
Eigen::Isometry3d tilted() {
  Eigen::Isometry3d T_base_from_camera = mount();
  T_base_from_camera.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  T_base_from_camera.rotate(Eigen::AngleAxisd(-0.05, Eigen::Vector3d::UnitX()));
  T_base_from_camera.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));
  return T_base_from_camera;
}

DepthInput input() {
  DepthInput in;
  in.camera = kCamera;
  in.T_base_from_camera = mount();
  return in;
}

/// Share by which the inverse depth of the ground changes between two grounds, at a pixel.
double change(const Eigen::Isometry3d& T_base_from_camera, int v, int u, double height, double pitch,
              double height_step, double pitch_step) {
  const auto inverse = [&](double sign) {
    const cv::Mat depth =
        groundDepth(kCamera, T_base_from_camera, height + sign * height_step, pitch + sign * pitch_step, 1e9);
    return 1.0 / static_cast<double>(depth.at<float>(v, u));
  };
  const double here =
      1.0 / static_cast<double>(groundDepth(kCamera, T_base_from_camera, height, pitch, 1e9).at<float>(v, u));
  return std::abs(inverse(1.0) - inverse(-1.0)) / 2.0 / here;
}

TEST(GroundRelativeStd, IsTheFiniteDifferenceOfGroundDepth) {
  constexpr double kStep = 1e-3, kHeight = -0.2, kPitch = 0.06;
  for (const Eigen::Isometry3d& T_base_from_camera : {mount(), tilted()}) {
    const cv::Mat by_pitch =
        groundRelativeStd(kCamera, T_base_from_camera, {kPitch, kHeight, {kStep, 0.0, 0.0}});
    const cv::Mat by_height =
        groundRelativeStd(kCamera, T_base_from_camera, {kPitch, kHeight, {0.0, kStep, 0.0}});
    const cv::Mat of_both =
        groundRelativeStd(kCamera, T_base_from_camera, {kPitch, kHeight, {0.02, 0.05, 0.1}});
    for (const auto& [v, u] : {std::pair(160, 200), std::pair(220, 30), std::pair(300, 390)}) {
      const double pitch = change(T_base_from_camera, v, u, kHeight, kPitch, 0.0, kStep);
      const double height = change(T_base_from_camera, v, u, kHeight, kPitch, kStep, 0.0);
      EXPECT_NEAR(static_cast<double>(by_pitch.at<float>(v, u)), pitch, 0.01 * pitch) << v;
      EXPECT_NEAR(static_cast<double>(by_height.at<float>(v, u)), height, 0.01 * height) << v;
      const double both =
          std::sqrt(std::pow(0.02 / kStep * pitch, 2) + std::pow(0.05 / kStep * height, 2) + 0.01);
      EXPECT_NEAR(static_cast<double>(of_both.at<float>(v, u)), both, 0.01 * both) << v;
    }
  }
}

// A level camera 1.5 m high sees the ground 10 m before it at row 160, 11 m before the base frame's origin:
// 1 mrad is 11 mm there, of 1.5 m.
TEST(GroundRelativeStd, LevelCamera) {
  const cv::Mat stds = groundRelativeStd(kCamera, mount(), {0.0, 0.0, {1e-3, 0.0, 0.0}});
  EXPECT_NEAR(static_cast<double>(stds.at<float>(160, 200)), 0.011 / 1.5, 1e-6);
  EXPECT_TRUE(std::isnan(stds.at<float>(100, 200)));  // the horizon
  EXPECT_TRUE(std::isnan(stds.at<float>(20, 200)));
}

/// A return 20 m before the camera, of 1.6 m by 1.8 m: columns 182 to 218, rows 98 to 130.
struct Street {
  Street() {
    in.radar_points = {{21.0F, 0.0F, 0.5F}};
    params.radar_ground.column_std = 0.25;
    params.radar_ground.background_std = 0.75;
    params.radar_ground.ground.uncertainty.pitch_std = 0.01;
    params.radar_ground.ground.uncertainty.relative_std = 0.05;
  }
  cv::Mat depth() const { return makeDepthEstimator(params)->estimate(in); }
  cv::Mat stds() const { return makeDepthEstimator(params)->relativeStd(in, depth()); }
  DepthInput in = input();
  DepthParams params;
};

TEST(RadarGroundStd, EverySurfaceHasItsOwn) {
  const Street street;
  const cv::Mat stds = street.stds();
  ASSERT_EQ(stds.type(), CV_32FC1);
  ASSERT_EQ(stds.size(), cv::Size(401, 301));
  EXPECT_FLOAT_EQ(stds.at<float>(115, 200), 0.25F);  // the column
  EXPECT_FLOAT_EQ(stds.at<float>(100, 185), 0.25F);
  EXPECT_FLOAT_EQ(stds.at<float>(20, 200), 0.75F);  // the background above it
  EXPECT_FLOAT_EQ(stds.at<float>(104, 5), 0.75F);   // and before the ground 150 m away
  const cv::Mat ground = groundRelativeStd(kCamera, mount(), {0.0, 0.0, {0.01, 0.05, 0.05}});
  for (const auto& [v, u] : {std::pair(160, 200), std::pair(300, 10), std::pair(120, 20)})
    EXPECT_FLOAT_EQ(stds.at<float>(v, u), ground.at<float>(v, u)) << v;
  EXPECT_GT(stds.at<float>(120, 20), 1.5F * stds.at<float>(300, 10));  // farther, less certain
}

// The borders that the image moved are those of its uncertainty: a patch twice as high as the column.
TEST(RadarGroundStd, FollowsColumnsThatTheImageMoved) {
  Street street;
  street.params.radar_ground.image_edges = true;
  street.in.image = cv::Mat(301, 401, CV_8UC1, cv::Scalar(100));
  street.in.image(cv::Rect(182, 76, 37, 54)).setTo(255);
  const cv::Mat depth = street.depth(), stds = street.stds();
  EXPECT_FLOAT_EQ(depth.at<float>(80, 200), 20.0F);
  EXPECT_FLOAT_EQ(stds.at<float>(80, 200), 0.25F);
  EXPECT_FLOAT_EQ(stds.at<float>(70, 200), 0.75F);
}

TEST(RadarGroundStd, UnknownWhereTheDepthIs) {
  Street street;
  street.params.radar_ground.background_depth = 0.0;
  cv::Mat depth = street.depth();
  depth(cv::Rect(0, 250, 50, 20)).setTo(kNaN);  // cleaned away meanwhile
  const cv::Mat stds = makeDepthEstimator(street.params)->relativeStd(street.in, depth);
  EXPECT_EQ(cv::countNonZero((stds == stds) != (depth == depth)), 0);
  EXPECT_TRUE(std::isnan(stds.at<float>(260, 10)));
  EXPECT_TRUE(std::isnan(stds.at<float>(20, 10)));
  EXPECT_GT(cv::countNonZero(stds == stds), 1000);
  EXPECT_THROW(makeDepthEstimator(street.params)->relativeStd(street.in, depth.rowRange(0, 100)),
               std::invalid_argument);
}

// A row of points 40 px apart on a wall; at 1600 px of width every px here is 4.
TEST(LidarStd, GrowsAwayFromThePoints) {
  DepthInput in = input();
  for (int v = 60; v <= 240; v += 8)
    for (int u = 20; u <= 380; u += 8)
      in.lidar_points.emplace_back((mount() * (25.0 * kCamera.rayOf(u, v))).cast<float>());
  DepthParams params;
  params.backend = "lidar";
  params.lidar.completion_kernel = 60;
  params.lidar.point_std = 0.02;
  params.lidar.completion_std = 0.005;
  const auto estimator = makeDepthEstimator(params);
  const cv::Mat depth = estimator->estimate(in);
  const cv::Mat stds = estimator->relativeStd(in, depth);
  const double per_pixel = 0.005 * 1600.0 / 401.0;
  EXPECT_FLOAT_EQ(stds.at<float>(100, 100), 0.02F);  // a point
  EXPECT_NEAR(static_cast<double>(stds.at<float>(100, 103)), std::hypot(0.02, 3.0 * per_pixel), 1e-4);
  EXPECT_NEAR(static_cast<double>(stds.at<float>(104, 104)), std::hypot(0.02, std::sqrt(32.0) * per_pixel),
              1e-4);
  EXPECT_TRUE(std::isnan(depth.at<float>(10, 200)));
  EXPECT_EQ(cv::countNonZero((stds == stds) != (depth == depth)), 0);
  EXPECT_THROW(estimator->relativeStd(in, depth.rowRange(0, 100)), std::invalid_argument);
}

TEST(ConstantStd, StandsWhereDepthIsKnown) {
  cv::Mat depth = (cv::Mat_<float>(1, 5) << 3.0F, kNaN, 0.0F, -2.0F, std::numeric_limits<float>::infinity());
  const cv::Mat stds = constantStd(depth, 0.125);
  EXPECT_FLOAT_EQ(stds.at<float>(0, 0), 0.125F);
  for (int u = 1; u < 5; ++u) EXPECT_TRUE(std::isnan(stds.at<float>(0, u))) << u;
  EXPECT_THROW(constantStd(cv::Mat(1, 1, CV_64FC1), 0.1), std::invalid_argument);
}

// A backend that was written before there was relativeStd.
TEST(DepthEstimator, DeclaresAConstantWhereItSaysNothing) {
  struct Wall : DepthEstimator {
    cv::Mat estimate(const DepthInput& in) override {
      cv::Mat depth(in.camera.height, in.camera.width, CV_32FC1, cv::Scalar(8.0));
      depth.at<float>(0, 0) = kNaN;
      return depth;
    }
    DepthNeeds needs() const override { return {}; }
  };
  Wall wall;
  const cv::Mat stds = wall.relativeStd(input(), wall.estimate(input()));
  EXPECT_FLOAT_EQ(stds.at<float>(100, 100), static_cast<float>(DepthParams{}.relative_std));
  EXPECT_TRUE(std::isnan(stds.at<float>(0, 0)));
}

TEST(DepthUncertainty, InvalidParametersAreRefusedByName) {
  DepthParams params;
  params.radar_ground.column_std = std::nan("");
  test::expectRefusal<InvalidParameter>([&] { makeDepthEstimator(params); }, {"column_std"});
}

}  // namespace
}  // namespace radar_dot
