// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>

#include "fixtures/literal_motion.h"
#include "fixtures/refusal.h"
#include "radar_dot/vision/motion_terms.h"

namespace radar_dot {
namespace {

namespace terms = motion_terms;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

const CameraIntrinsics kCamera{500.0, 500.0, 159.5, 119.5, 320, 240};

/// A wall at 20 m before a camera that drives 1 m towards it: a static point's flow is known by hand, since
/// u' - cx = (u - cx) 20 / 19.
MotionInput wall() {
  MotionInput input;
  input.camera = kCamera;
  input.T_current_from_previous.translation() = Eigen::Vector3d(0.0, 0.0, -1.0);
  input.depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(20.0));
  input.next_depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(19.0));
  input.flow = cv::Mat(240, 320, CV_32FC2);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      input.flow.at<cv::Vec2f>(v, u) =
          cv::Vec2f(static_cast<float>((u - 159.5) / 19.0), static_cast<float>((v - 119.5) / 19.0));
    }
  }
  return input;
}

/// Adds `flow` to a square of `size` px at (u, v).
void move(MotionInput& input, int u, int v, int size, cv::Vec2f flow) {
  for (int row = v; row < v + size; ++row)
    for (int column = u; column < u + size; ++column) input.flow.at<cv::Vec2f>(row, column) += flow;
}

/// Smooth depths with holes, noise on the flow, everything that can be excluded.
MotionInput randomScene(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random] { return static_cast<float>(static_cast<double>(random()) / 4294967296.0); };
  MotionInput input = wall();
  input.T_current_from_previous.linear() =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(0.3, 0.9, 0.1).normalized()).toRotationMatrix();
  input.T_current_from_previous.translation() = Eigen::Vector3d(0.2, -0.05, -0.8);
  input.pixel_scale = 2.0;
  input.flow_valid = cv::Mat(240, 320, CV_8UC1, cv::Scalar(255));
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      input.depth.at<float>(v, u) =
          uniform() < 0.05F ? kNaN : 2.0F + 0.4F * static_cast<float>(v) + 3.0F * uniform();
      input.next_depth.at<float>(v, u) =
          uniform() < 0.02F ? kNaN : 2.0F + 0.4F * static_cast<float>(v) + 3.0F * uniform();
      if (uniform() < 0.05F) input.flow_valid.at<std::uint8_t>(v, u) = 0;
      input.flow.at<cv::Vec2f>(v, u) += cv::Vec2f(uniform(), uniform());
    }
  }
  input.depth.at<float>(7, 9) = std::numeric_limits<float>::infinity();
  input.depth.at<float>(8, 9) = -3.0F;
  input.depth.at<float>(9, 9) = 0.0F;
  input.flow.at<cv::Vec2f>(50, 60) = cv::Vec2f(kNaN, 1.0F);
  move(input, 100, 90, 40, {6.0F, 2.0F});
  return input;
}

TEST(MotionTerms, PredictionIsTheProjectionOfTheMovedPoint) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d(0.2, 1.0, -0.3).normalized()).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.4, -0.1, -1.5);
  const terms::PixelMotion pixel(kCamera, motion);
  for (const double depth : {2.0, 15.0, 90.0}) {
    const Eigen::Vector3d moved = motion * (depth * kCamera.rayOf(40.0, 200.0));
    const Eigen::Vector2d expected = kCamera.project(moved);
    const terms::Prediction found = terms::predict(pixel, 40.0F, 200.0F, static_cast<float>(depth));
    EXPECT_NEAR(found.u, expected.x(), 2e-3);
    EXPECT_NEAR(found.v, expected.y(), 2e-3);
    EXPECT_NEAR(found.depth, moved.z(), 1e-4);
  }
}

TEST(MotionTerms, FollowThePapersFormulas) {
  EXPECT_FLOAT_EQ(terms::flowResidual(3.0F, 1.0F, 0.0F, 5.0F, 2.0F), 10.0F);  // 2 |(3, -4)|
  EXPECT_FLOAT_EQ(terms::depthResidual(12.0F, 15.5F), 3.5F);
  EXPECT_FLOAT_EQ(terms::depthResidual(kNaN, 15.5F), 0.0F);
  EXPECT_FLOAT_EQ(terms::depthTolerance(0.5F, 1.0F), 1.0F);
  EXPECT_FLOAT_EQ(terms::depthTolerance(7.0F, 1.0F), 7.0F);
  // 100 px away, sigma 50 px: exp(-2); and 60 and 80 px make 100.
  EXPECT_NEAR(terms::foeFactor(100.0F, 1.0F / 5000.0F), std::exp(-2.0), 1e-7);
  EXPECT_NEAR(terms::foeFactor(60.0F, 1.0F / 5000.0F) * terms::foeFactor(-80.0F, 1.0F / 5000.0F),
              std::exp(-2.0), 1e-7);
  EXPECT_FLOAT_EQ(terms::flowTolerance(20.0F, 10.0F, 1.0F, 1.0F), 6.0F);  // (1 + 2) (1 + 1)
  EXPECT_FLOAT_EQ(terms::flowTolerance(20.0F, 0.1F, 2.0F, 0.0F), 11.0F);
  EXPECT_FLOAT_EQ(terms::motionScore(6.0F, 3.0F, 4.0F, 8.0F, 0.5F), 2.25F);
  EXPECT_FLOAT_EQ(terms::robustThreshold(1.0F, 0.5F, 6.0F, 0.25F), 4.0F);
  EXPECT_FLOAT_EQ(terms::robustThreshold(0.01F, 0.01F, 6.0F, 0.25F), 0.25F);
}

TEST(MotionTerms, FocusOfExpansionIsWhereTheCameraDrives) {
  const auto ahead = terms::focusOfExpansion(kCamera, {0.0, 0.0, -1.0});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->x(), 159.5, 1e-9);
  EXPECT_NEAR(ahead->y(), 119.5, 1e-9);
  // Driving towards (1, 0, 10): 50 px right of the centre, whichever sign t has.
  EXPECT_NEAR(terms::focusOfExpansion(kCamera, {-0.1, 0.0, -1.0})->x(), 209.5, 1e-9);
  EXPECT_NEAR(terms::focusOfExpansion(kCamera, {0.1, 0.0, 1.0})->x(), 209.5, 1e-9);
  EXPECT_FALSE(terms::focusOfExpansion(kCamera, {0.0, 0.0, 0.0}));
  EXPECT_FALSE(terms::focusOfExpansion(kCamera, {2.0, 0.0, 0.001}));
}

TEST(MotionTerms, BilinearIsLinearAndKnowsTheBorders) {
  cv::Mat image(3, 4, CV_32FC1);
  for (int v = 0; v < 3; ++v)
    for (int u = 0; u < 4; ++u) image.at<float>(v, u) = static_cast<float>(10 * v + u);
  EXPECT_FLOAT_EQ(terms::bilinear(terms::FloatImage(image), 1.25F, 0.5F), 6.25F);
  EXPECT_FLOAT_EQ(terms::bilinear(terms::FloatImage(image), 3.0F, 2.0F), 23.0F);
  EXPECT_TRUE(std::isnan(terms::bilinear(terms::FloatImage(image), 3.01F, 1.0F)));
  EXPECT_TRUE(std::isnan(terms::bilinear(terms::FloatImage(image), -0.01F, 1.0F)));
  EXPECT_TRUE(std::isnan(terms::bilinear(terms::FloatImage(image), kNaN, 1.0F)));
}

TEST(MotionSegmenter, StaticWorldIsEmpty) {
  MotionSegmenter segmenter;
  const MotionResult& result = segmenter.segment(wall());
  EXPECT_EQ(cv::countNonZero(result.mask), 0);
  EXPECT_DOUBLE_EQ(result.median_depth, 20.0);
  EXPECT_LT(result.median, 1e-4);
  // Points near the border leave the image: 320 / 20 columns and 240 / 20 rows, half on each side.
  EXPECT_EQ(result.valid_count, static_cast<std::size_t>(304 * 228));
  EXPECT_EQ(cv::countNonZero(result.valid), 304 * 228);
}

TEST(MotionSegmenter, FindsWhatMovesAcross) {
  MotionInput input = wall();
  move(input, 40, 50, 30, {0.0F, 4.0F});
  MotionParams params;
  params.paper.min_threshold = 0.5;
  MotionSegmenter segmenter(params);
  const MotionResult& result = segmenter.segment(input);
  EXPECT_EQ(cv::countNonZero(result.mask), 900);
  EXPECT_EQ(cv::countNonZero(result.mask(cv::Rect(40, 50, 30, 30))), 900);
  // e_flow = 4 px at the median depth: sigma_flow = 2, far from the focus of expansion.
  EXPECT_GT(result.score.at<float>(60, 45), 1.2F);
  EXPECT_LE(result.score.at<float>(60, 45), 2.0F);
}

TEST(MotionSegmenter, FindsByDepthWhatFlowDoesNotShow) {
  MotionInput input = wall();
  input.next_depth(cv::Rect(200, 60, 40, 40)).setTo(24.0);  // went 5 m ahead of where a static point would be
  MotionParams params;
  params.paper.lambda = 1.0;  // S = 5 m / 20 m
  params.paper.min_threshold = 0.1;
  MotionSegmenter segmenter(params);
  const MotionResult& result = segmenter.segment(input);
  const int found = cv::countNonZero(result.mask);
  EXPECT_NEAR(found, 38 * 38, 150);  // seen 20 / 19 smaller from the first image
  EXPECT_EQ(cv::countNonZero(result.mask(cv::Rect(195, 60, 50, 50))), found);
  params.paper.lambda = 0.0;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
}

TEST(MotionSegmenter, LeavesOutWhatIsHiddenBehindSomethingNearer) {
  MotionInput input = wall();
  input.next_depth(cv::Rect(200, 60, 40, 40)).setTo(5.0);
  MotionSegmenter segmenter;
  const MotionResult& result = segmenter.segment(input);
  EXPECT_EQ(result.valid.at<std::uint8_t>(80, 218), 0);
  EXPECT_TRUE(std::isnan(result.score.at<float>(80, 218)));
  EXPECT_EQ(result.mask.at<std::uint8_t>(80, 218), 0);
}

TEST(MotionSegmenter, DynamicReturnsRaiseTheScoreAroundThem) {
  MotionInput input = wall();
  move(input, 140, 100, 30, {0.0F, 0.5F});
  MotionParams params;
  params.paper.min_threshold = 0.3;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
  params.radar.dynamic_gain = 2.0;
  input.dynamic_points = {{{0.0F, 0.0F, 20.0F}}, {{0.0F, 0.0F, -5.0F}}, {{kNaN, 0.0F, 9.0F}}};
  EXPECT_GT(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 400);
}

// Single precision against double: pixels at a limit may fall on either side.
TEST(MotionSegmenter, IsThePapersMask) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const MotionInput input = randomScene(seed);
    MotionParams params;
    params.paper.k = 2.0 + 0.5 * seed;
    params.paper.min_threshold = 0.0;
    params.predicted_in_view = seed % 2 == 0;
    const test::LiteralMotion expected = test::literalMotion(input, params);
    MotionSegmenter segmenter(params);
    const MotionResult& result = segmenter.segment(input);
    EXPECT_EQ(result.median_depth, expected.median_depth);
    EXPECT_NEAR(result.median, expected.median, 1e-4);
    EXPECT_NEAR(result.mad, expected.mad, 1e-4);
    EXPECT_NEAR(result.threshold, expected.threshold, 5e-4);
    cv::Mat score;
    result.score.convertTo(score, CV_64F);
    const cv::Mat valid = expected.score >= 0.0;
    EXPECT_LE(cv::countNonZero(result.valid != valid), 2);
    EXPECT_LT(cv::norm(score, expected.score, cv::NORM_INF, valid & result.valid), 1e-3);
    EXPECT_LE(cv::countNonZero(result.mask != expected.mask), 10);
    EXPECT_GT(cv::countNonZero(result.mask), 100);
    EXPECT_LT(cv::countNonZero(result.valid), 320 * 240);
  }
}

TEST(MotionSegmenter, NothingKnownIsNothingFound) {
  MotionInput input = wall();
  input.depth.setTo(kNaN);
  MotionSegmenter segmenter;
  const MotionResult& result = segmenter.segment(input);
  EXPECT_EQ(result.valid_count, 0U);
  EXPECT_EQ(cv::countNonZero(result.mask), 0);
}

TEST(MotionSegmenter, RefusesWhatDoesNotFit) {
  MotionSegmenter segmenter;
  MotionInput input = wall();
  input.depth = cv::Mat(10, 10, CV_32FC1);
  test::expectRefusal([&] { segmenter.segment(input); }, {"depth is 10 x 10 px"});
  input = wall();
  input.flow = cv::Mat(240, 320, CV_64FC2);
  EXPECT_THROW(segmenter.segment(input), std::invalid_argument);
  input = wall();
  input.T_current_from_previous.translation().x() = std::nan("");
  EXPECT_THROW(segmenter.segment(input), std::invalid_argument);
  MotionParams params;
  params.paper.foe_std = 0.0;
  EXPECT_THROW(MotionSegmenter{params}, std::invalid_argument);
}

TEST(ExpectedFlow, IsKnownWhereDepthIs) {
  MotionInput input = wall();
  input.depth.at<float>(10, 10) = kNaN;
  const cv::Mat flow = expectedFlow(kCamera, input.T_current_from_previous, input.depth);
  EXPECT_NEAR(flow.at<cv::Vec2f>(20, 300)[0], (300 - 159.5) / 19.0, 1e-3);
  EXPECT_NEAR(flow.at<cv::Vec2f>(20, 300)[1], (20 - 119.5) / 19.0, 1e-3);
  EXPECT_TRUE(std::isnan(flow.at<cv::Vec2f>(10, 10)[0]));
}

}  // namespace
}  // namespace radar_dot
