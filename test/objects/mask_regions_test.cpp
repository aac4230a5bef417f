// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/mask_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "fixtures/camera_mount.h"

namespace radar_dot {
namespace {

const CameraIntrinsics kCamera{400.0, 400.0, 199.5, 99.5, 400, 200};

struct Images {
  cv::Mat mask = cv::Mat::zeros(200, 400, CV_8UC1);
  cv::Mat depth = cv::Mat(200, 400, CV_32FC1, cv::Scalar(60.0));
  cv::Mat residual = cv::Mat::zeros(200, 400, CV_32FC2);
  /// An object in a box of pixels that moves with `velocity` (m/s, camera frame) for `interval` s.
  // NOLINTNEXTLINE(readability-make-member-function-const): the pixels change
  void add(const cv::Rect& box, float metres, const Eigen::Vector3d& velocity, double interval) {
    mask(box) = 255;
    depth(box) = metres;
    const double u = box.x + 0.5 * (box.width - 1);
    const Eigen::Vector3d before = static_cast<double>(metres) * kCamera.rayOf(u, 99.5);
    const Eigen::Vector2d shift = kCamera.project(before + interval * velocity) - kCamera.project(before);
    residual(box) = cv::Scalar(shift.x(), shift.y());
  }
  std::vector<MaskRegion> regions(double interval) const {
    return regionsOfMask(mask, depth, residual, interval, kCamera, test::lookingAhead({1.5, 0.0, 1.5}));
  }
};

TEST(MaskRegions, ACrossingObjectHasItsLateralVelocity) {
  constexpr double kInterval = 0.05;
  Images images;
  images.add({100, 80, 41, 41}, 20.F, {4.0, 0.0, -3.0}, kInterval);
  const auto regions = images.regions(kInterval);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].pixel_count, 41U * 41U);
  EXPECT_EQ(regions[0].box.x, 100);
  EXPECT_EQ(regions[0].box.height, 41);
  EXPECT_NEAR(regions[0].position.x(), 21.5, 1e-3);
  EXPECT_NEAR(regions[0].position.y(), 20.0 * 79.5 / 400.0, 1e-3);
  const Eigen::Vector2d velocity(-3.0, -4.0);  // base frame: nearer, to the right
  EXPECT_NEAR(regions[0].lateral.row.dot(velocity), regions[0].lateral.value, 0.05);
  // What moves along the ray shifts no pixel.
  const Eigen::Vector2d ray(1.0, 79.5 / 400.0);
  EXPECT_NEAR(regions[0].lateral.row.dot(ray), 0.0, 1e-9);
}

TEST(MaskRegions, SmallOnesAndThoseWithoutDepthAreLeftOut) {
  Images images;
  images.add({100, 80, 5, 5}, 20.F, {4.0, 0.0, 0.0}, 0.1);
  images.add({200, 80, 20, 20}, std::numeric_limits<float>::quiet_NaN(), {0.0, 0.0, 0.0}, 0.1);
  EXPECT_TRUE(images.regions(0.1).empty());
}

TEST(MaskRegions, WithoutFlowThePlaceIsKnownAndTheVelocityIsNot) {
  Images images;
  images.add({100, 80, 41, 41}, 20.F, {4.0, 0.0, -3.0}, 0.05);
  const MaskRegion with_flow = images.regions(0.05).at(0);
  images.residual = cv::Scalar::all(std::numeric_limits<double>::quiet_NaN());
  const auto regions = images.regions(0.05);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].position, with_flow.position);
  EXPECT_EQ(regions[0].covariance, with_flow.covariance);
  EXPECT_TRUE(std::isnan(regions[0].flow_residual.x()));
  EXPECT_EQ(regions[0].lateral.value, 0.0);
  EXPECT_EQ(regions[0].lateral.variance, std::numeric_limits<double>::infinity());
}

// A pixel is a longer way for what is farther.
TEST(MaskRegions, VarianceGrowsWithTheDepth) {
  Images images;
  images.add({50, 80, 20, 20}, 10.F, {1.0, 0.0, 0.0}, 0.1);
  images.add({250, 80, 20, 20}, 40.F, {1.0, 0.0, 0.0}, 0.1);
  const auto regions = images.regions(0.1);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_GT(regions[1].lateral.variance, 10.0 * regions[0].lateral.variance);
  EXPECT_GT(regions[1].covariance(0, 0), 10.0 * regions[0].covariance(0, 0));
}

TEST(MaskRegions, RefusesImagesThatDoNotFit) {
  Images images;
  EXPECT_THROW(images.regions(0.0), std::invalid_argument);
  images.depth = cv::Mat(10, 10, CV_32FC1);
  EXPECT_THROW(images.regions(0.1), std::invalid_argument);
  images = Images();
  images.mask = cv::Mat::zeros(200, 400, CV_32FC1);
  EXPECT_THROW(images.regions(0.1), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot
