// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>

#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr int kWidth = 160, kHeight = 120;

/// A camera that drives towards a wall, 1 m from each image to the next: 21, 20 and 19 m away.
class Wall {
 public:
  static CameraIntrinsics camera() { return {250.0, 250.0, 79.5, 59.5, kWidth, kHeight}; }
  static cv::Mat depth(double metres) { return {kHeight, kWidth, CV_32FC1, cv::Scalar(metres)}; }

  /// The pair that begins at this distance.
  static MotionInput pair(double metres) {
    MotionInput input;
    input.camera = camera();
    input.T_current_from_previous.translation() = Eigen::Vector3d(0.0, 0.0, -1.0);
    input.motion_covariance.diagonal() << 1e-6, 2e-6, 3e-6, 1e-4, 2e-4, 3e-4;
    input.depth = depth(metres);
    input.next_depth = depth(metres - 1.0);
    input.flow = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
    return input;
  }
  /// The second image of the pair that began at 21 m, seen together with the first.
  static MotionInput before() {
    MotionInput first = pair(21.0);
    MotionInput seen = seenFromSecond(first, cv::Mat(), cv::Mat());
    seen.flow = expectedFlow(seen.camera, seen.T_current_from_previous, seen.depth);
    return seen;
  }
  static MotionParams params() {
    MotionParams params;
    params.score = MotionScore::kUncertainty;
    params.uncertainty.noise.flow_std = 0.5;
    params.uncertainty.noise.depth_std = 0.05;
    params.uncertainty.false_alarm = 1e-3;
    params.cleanup.opening = params.cleanup.closing = 0;
    params.uncertainty.hysteresis_ratio = params.uncertainty.min_scale = 1.0;
    return params;
  }
};

const cv::Rect kPatch(100, 40, 20, 10);

void move(cv::Mat& flow, const cv::Rect& part, float down) {
  for (int v = part.y; v < part.y + part.height; ++v)
    for (int u = part.x; u < part.x + part.width; ++u) flow.at<cv::Vec2f>(v, u)[1] += down;
}

int moving(const MotionInput& input, const MotionInput* before = nullptr) {
  MotionSegmenter segmenter(Wall::params());
  return cv::countNonZero(segmenter.segment(input, before).mask);
}

TEST(SeenFromSecond, TurnsThePairRound) {
  MotionInput pair = Wall::pair(21.0);
  pair.T_current_from_previous.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const MotionInput seen = seenFromSecond(pair, pair.flow, cv::Mat());
  EXPECT_TRUE(
      (seen.T_current_from_previous * pair.T_current_from_previous).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(seen.depth.at<float>(0, 0), 20.0F);
  EXPECT_EQ(seen.next_depth.at<float>(0, 0), 21.0F);
  // Small motions D after T, drawn at will, are small motions inv(T) inv(D) T after inv(T).
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  const Eigen::Isometry3d& T = pair.T_current_from_previous;
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> change = Eigen::Matrix<double, 6, 1>::Zero();
    change[i] = std::sqrt(pair.motion_covariance(i, i));
    Eigen::Matrix4d D = Eigen::Matrix4d::Zero();  // of X -> omega x X + tau
    D(0, 1) = -change[2], D(0, 2) = change[1], D(1, 2) = -change[0];
    D(1, 0) = change[2], D(2, 0) = -change[1], D(2, 1) = change[0];
    D.topRightCorner<3, 1>() = change.tail<3>();
    const Eigen::Matrix4d after = T.inverse().matrix() * D * T.matrix();
    Eigen::Matrix<double, 6, 1> turned;
    turned << after(2, 1), after(0, 2), after(1, 0), after.topRightCorner<3, 1>();
    sum += turned * turned.transpose();
  }
  EXPECT_NEAR((seen.motion_covariance - sum).norm(), 0.0, 1e-12);
  EXPECT_GT(seen.motion_covariance(5, 5), 1e-4);
}

TEST(LookBack, APixelUnknownInOneOfThePairsIsSeenInTheOther) {
  MotionInput pair = Wall::pair(20.0);
  MotionInput before = Wall::before();
  EXPECT_EQ(moving(pair, &before), 0);
  pair.flow(kPatch).setTo(cv::Scalar::all(std::nan("")));
  move(before.flow, kPatch, 10.0F);
  EXPECT_EQ(moving(pair), 0);
  EXPECT_EQ(moving(pair, &before), kPatch.area());
  // The other way round: unknown before.
  MotionInput moves = Wall::pair(20.0);
  move(moves.flow, kPatch, 10.0F);
  before.flow(kPatch).setTo(cv::Scalar::all(std::nan("")));
  EXPECT_EQ(moving(moves, &before), kPatch.area());
}

TEST(LookBack, TheScoreIsTheRootMeanSquare) {
  MotionSegmenter segmenter(Wall::params());
  const auto score = [&](const MotionInput& input, const MotionInput* before) {
    return segmenter.segment(input, before).score.at<float>(45, 110);
  };
  MotionInput pair = Wall::pair(20.0);
  MotionInput before = Wall::before();
  move(pair.flow, kPatch, 6.0F);
  move(before.flow, kPatch, 2.0F);
  const float here = score(pair, nullptr);
  const float there = score(before, nullptr);
  EXPECT_GT(here, 2.0F * there);
  EXPECT_NEAR(score(pair, &before), std::sqrt(0.5F * (here * here + there * there)), 1e-4F);
}

TEST(LookBack, IsForTheScoreByUncertaintyAndOneGrid) {
  const MotionInput pair = Wall::pair(20.0);
  MotionInput before = Wall::before();
  test::expectRefusal([&] { MotionSegmenter().segment(pair, &before); }, {"paper"});
  before.camera.width = 80;
  test::expectRefusal([&] { MotionSegmenter(Wall::params()).segment(pair, &before); }, {"previous pair"});
}

// In the image before something at 10 m hid a part of the wall, and moved.
class Uncovered : public ::testing::Test {
 protected:
  Uncovered() {
    // The wall was 21 m away then, so that this place was seen 1.5 px nearer to the middle, in kPatch.
    depth_before_(kPatch).setTo(10.0);
    log_odds_(kPatch).setTo(kMaxLogOdds);
    move(before_.flow, {100, 40, 50, 10}, 10.0F);
    before_.fb_error = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(10.0));
  }
  bool at(int u, int v) const {
    return uncoveredPixels(before_, log_odds_, depth_before_, Wall::params().uncertainty.noise)
               .at<std::uint8_t>(v, u) != 0;
  }

  MotionInput before_ = Wall::before();
  cv::Mat log_odds_{kHeight, kWidth, CV_32FC1, cv::Scalar(-kMaxLogOdds)};
  cv::Mat depth_before_ = Wall::depth(21.0);
};

TEST_F(Uncovered, IsWhatWasBehindAMoverAndHasNoFlowOfItsOwn) {
  EXPECT_TRUE(at(110, 45));
  EXPECT_FALSE(at(140, 45)) << "it was beside the mover";
  EXPECT_FALSE(at(20, 20));
  before_.fb_error.setTo(kNaN);
  EXPECT_TRUE(at(110, 45)) << "the flow leads out of the image and closes nothing";
  log_odds_.setTo(kNaN);
  EXPECT_FALSE(at(110, 45)) << "whether something moved there is not known";
}

TEST_F(Uncovered, IsNotWhatClosesAsWellAsItMoves) {
  before_.fb_error.setTo(4.9);
  EXPECT_FALSE(at(110, 45)) << "less than half of the motion";
  before_.fb_error.setTo(5.1);
  EXPECT_TRUE(at(110, 45));
}

TEST_F(Uncovered, IsNotWhatClosesButForTheNoiseOfTwoFlows) {
  MotionInput still = Wall::before();
  still.fb_error = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(2.0));
  before_ = still;
  EXPECT_FALSE(at(110, 45));
  before_.fb_error.setTo(3.0);  // 3 sqrt(2) (0.5 + 0.03 * 1.7 px) = 2.3 px
  EXPECT_TRUE(at(110, 45));
}

TEST_F(Uncovered, IsNotBeforeWhatHid) {
  depth_before_(kPatch).setTo(30.0);
  EXPECT_FALSE(at(110, 45));
  depth_before_(kPatch).setTo(24.0);
  EXPECT_TRUE(at(110, 45)) << "depth of what moves is uncertain";
}

TEST_F(Uncovered, IsNotKnownWithoutTheErrorOfTheFlow) {
  before_.fb_error.release();
  EXPECT_TRUE(uncoveredPixels(before_, log_odds_, depth_before_, {}).empty());
}

TEST(Belief, LogOddsAreStandardDeviationsAboveTheThreshold) {
  MotionSegmenter segmenter(Wall::params());
  MotionInput pair = Wall::pair(20.0);
  move(pair.flow, kPatch, 2.0F);
  pair.flow.at<cv::Vec2f>(0, 0) = {kNaN, kNaN};
  move(pair.flow, {10, 10, 5, 5}, 50.0F);
  const MotionResult& result = segmenter.segment(pair);
  const cv::Mat odds = logOdds(result);
  EXPECT_FLOAT_EQ(odds.at<float>(45, 110),
                  result.score.at<float>(45, 110) - static_cast<float>(result.threshold));
  EXPECT_EQ(odds.at<float>(12, 12), kMaxLogOdds);
  EXPECT_TRUE(std::isnan(odds.at<float>(0, 0)));
  EXPECT_LT(odds.at<float>(100, 20), -3.0F);
}

TEST(Belief, IsCarriedByTheFlowBackAndForgotten) {
  cv::Mat odds(4, 6, CV_32FC1, cv::Scalar(-2.0));
  odds.at<float>(1, 2) = 4.0F;
  odds.at<float>(3, 5) = kNaN;
  cv::Mat back(4, 6, CV_32FC2, cv::Scalar(-1.0, 0.0));  // everything moved by 1 px to the right
  back.at<cv::Vec2f>(3, 0) = {5.0F, 0.0F};
  const cv::Mat carried = carriedBelief(odds, back, 0.5);
  EXPECT_FLOAT_EQ(carried.at<float>(1, 3), 2.0F);
  EXPECT_FLOAT_EQ(carried.at<float>(1, 2), -1.0F);
  EXPECT_TRUE(std::isnan(carried.at<float>(1, 0)));  // was not in the image
  EXPECT_TRUE(std::isnan(carried.at<float>(3, 0)));  // nothing was known
  EXPECT_NEAR(forgetting(0.5, 0.5), std::exp(-1.0), 1e-12);
  EXPECT_NEAR(forgetting(-0.5, 0.5), std::exp(-1.0), 1e-12);
  EXPECT_EQ(forgetting(0.5, 0.0), 0.0);
  test::expectRefusal([&] { carriedBelief(odds, cv::Mat(4, 4, CV_32FC2), 1.0); }, {"flow_back"});
}

TEST(Belief, MovesTheThresholdAndStandsForTheUnknown) {
  MotionInput pair = Wall::pair(20.0);
  pair.belief = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(kNaN));
  move(pair.flow, kPatch, 2.5F);  // too little by itself
  EXPECT_EQ(moving(pair), 0);
  pair.belief(kPatch).setTo(2.0);
  EXPECT_EQ(moving(pair), kPatch.area());
  move(pair.flow, kPatch, 2.0F);
  EXPECT_EQ(moving(pair), kPatch.area());
  pair.belief(kPatch).setTo(-5.0);
  EXPECT_EQ(moving(pair), 0);
  pair.flow(kPatch).setTo(cv::Scalar::all(std::nan("")));
  pair.belief(kPatch).setTo(2.0);
  EXPECT_EQ(moving(pair), kPatch.area());
  pair.belief(kPatch).setTo(0.5);  // nearly forgotten
  EXPECT_EQ(moving(pair), 0);
}

}  // namespace
}  // namespace radar_dot
