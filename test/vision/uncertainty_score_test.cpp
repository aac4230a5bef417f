// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>

#include "fixtures/refusal.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/uncertainty_terms.h"

namespace radar_dot {
namespace {

namespace terms = uncertainty_terms;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const CameraIntrinsics kCamera{500.0, 480.0, 159.5, 119.5, 320, 240};

Eigen::Isometry3d someMotion() {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, 1.0, -0.2).normalized()).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.3, -0.1, -1.4);
  return motion;
}

Eigen::Vector2d pixelOf(const Eigen::Isometry3d& motion, double u, double v, double depth) {
  return kCamera.project(motion * (depth * kCamera.rayOf(u, v)));
}

Matrix6 someCovariance(double rotation_std, double translation_std) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6 root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = normal(random);
  Vector6 scale;
  scale << Eigen::Vector3d::Constant(rotation_std), Eigen::Vector3d::Constant(translation_std);
  root = scale.asDiagonal() * root;
  return root * root.transpose();
}

TEST(UncertaintyTerms, DerivativeByInverseDepth) {
  const Eigen::Isometry3d motion = someMotion();
  const motion_terms::PixelMotion pixel(kCamera, motion);
  for (const double depth : {3.0, 12.0, 60.0}) {
    const double step = 1e-5 / depth;
    const Eigen::Vector2d expected = (pixelOf(motion, 40.0, 200.0, 1.0 / (1.0 / depth + step)) -
                                      pixelOf(motion, 40.0, 200.0, 1.0 / (1.0 / depth - step))) /
                                     (2.0 * step);
    const auto d = static_cast<float>(depth);
    const terms::PixelShift found =
        terms::byInverseDepth(pixel, d, motion_terms::predict(pixel, 40.0F, 200.0F, d));
    EXPECT_NEAR(found.u, expected.x(), 2e-4 * expected.norm()) << depth;
    EXPECT_NEAR(found.v, expected.y(), 2e-4 * expected.norm()) << depth;
  }
}

/// J times the unit vector of one of omega and tau.
terms::PixelShift shiftBy(int component, const Eigen::Vector2d& pixel, double depth) {
  float unit[6] = {};
  unit[component] = 1.0F;
  return terms::byMotion(static_cast<float>(kCamera.fx), static_cast<float>(kCamera.fy),
                         static_cast<float>((pixel.x() - kCamera.cx) / kCamera.fx),
                         static_cast<float>((pixel.y() - kCamera.cy) / kCamera.fy),
                         static_cast<float>(1.0 / depth),
                         {unit[0], unit[1], unit[2], unit[3], unit[4], unit[5]});
}

TEST(UncertaintyTerms, DerivativeByMotion) {
  const Eigen::Isometry3d motion = someMotion();
  for (const double depth : {3.0, 60.0}) {
    const Eigen::Vector3d seen = motion * (depth * kCamera.rayOf(250.0, 30.0));
    const Eigen::Vector2d there = kCamera.project(seen);
    for (int i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-6;
      const auto moved = [&](double step) {
        Vector6 change = Vector6::Zero();
        change[i] = step;
        Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
        if (i < 3) small.linear() = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(i)).toRotationMatrix();
        small.translation() = change.tail<3>();
        return kCamera.project(small * seen);
      };
      const Eigen::Vector2d expected = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
      const terms::PixelShift found = shiftBy(i, there, seen.z());
      EXPECT_NEAR(found.u, expected.x(), 1e-3 + 1e-5 * expected.norm()) << i;
      EXPECT_NEAR(found.v, expected.y(), 1e-3 + 1e-5 * expected.norm()) << i;
    }
  }
}

TEST(UncertaintyTerms, SpreadOfTheMotionIsJSigmaJt) {
  const Eigen::Vector2d pixel(310.0, 20.0);
  Eigen::Matrix<double, 2, 6> jacobian;
  for (int i = 0; i < 6; ++i) {
    const terms::PixelShift shift = shiftBy(i, pixel, 10.0);
    jacobian.col(i) << static_cast<double>(shift.u), static_cast<double>(shift.v);
  }
  Matrix6 singular = Matrix6::Zero();  // nothing but pitch and the way ahead is uncertain
  singular(0, 0) = 1e-4;
  singular(5, 5) = 0.01;
  for (const Matrix6& covariance : {someCovariance(0.01, 0.1), singular}) {
    const Eigen::Matrix2d expected = jacobian * covariance * jacobian.transpose();
    Eigen::Matrix2d found = Eigen::Matrix2d::Zero();
    for (const terms::SmallMotion& direction : terms::spreadOf(covariance)) {
      const terms::PixelShift shift =
          terms::byMotion(static_cast<float>(kCamera.fx), static_cast<float>(kCamera.fy),
                          static_cast<float>((pixel.x() - kCamera.cx) / kCamera.fx),
                          static_cast<float>((pixel.y() - kCamera.cy) / kCamera.fy), 0.1F, direction);
      const Eigen::Vector2d moved(static_cast<double>(shift.u), static_cast<double>(shift.v));
      found += moved * moved.transpose();
    }
    EXPECT_NEAR((found - expected).norm(), 0.0, 1e-4 * expected.norm());
  }
  EXPECT_EQ(terms::spreadOf(singular).size(), 2U);
  EXPECT_TRUE(terms::spreadOf(Matrix6::Zero()).empty());
  EXPECT_THROW(terms::spreadOf(-Matrix6::Identity()), std::invalid_argument);
}

TEST(UncertaintyTerms, SquaredDistance) {
  EXPECT_FLOAT_EQ(terms::squaredDistance(3.0F, 4.0F, {1.0F, 0.0F, 4.0F}), 9.0F + 4.0F);
  Eigen::Matrix2d covariance;
  covariance << 5.0, 2.0, 2.0, 3.0;
  const Eigen::Vector2d r(1.0, -2.0);
  EXPECT_NEAR(terms::squaredDistance(1.0F, -2.0F, {5.0F, 2.0F, 3.0F}), r.dot(covariance.inverse() * r), 1e-5);
}

TEST(UncertaintyTerms, ChiThresholdsAreThoseOfTheTables) {
  EXPECT_NEAR(terms::chiThreshold(2, 0.05), std::sqrt(5.9915), 1e-4);
  EXPECT_NEAR(terms::chiThreshold(2, 1e-5), std::sqrt(23.0259), 1e-4);
  EXPECT_NEAR(terms::chiThreshold(3, 0.01), std::sqrt(11.3449), 1e-4);
  EXPECT_NEAR(terms::chiMedian(2), std::sqrt(1.3863), 1e-4);
  EXPECT_NEAR(terms::chiMedian(3), std::sqrt(2.3660), 1e-4);
  EXPECT_THROW(terms::chiThreshold(1, 0.1), std::invalid_argument);
  EXPECT_THROW(terms::chiThreshold(2, 0.0), std::invalid_argument);
}

/// A static world whose flow, depth and motion err exactly as the parameters say.
class StaticWorld {
 public:
  explicit StaticWorld(MotionParams params) : params_(params) {}

  MotionInput input(const Matrix6& motion_covariance) {
    MotionInput input;
    input.camera = kCamera;
    input.T_current_from_previous = someMotion();
    input.motion_covariance = motion_covariance;
    input.depth.create(kCamera.height, kCamera.width, CV_32FC1);
    input.flow.create(kCamera.height, kCamera.width, CV_32FC2);
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const double depth = 10.0 + 0.05 * u + 0.03 * v;
        // The errors of the motion are drawn for every pixel again, so that their spread shows in one image.
        const Eigen::Isometry3d motion = smallMotion(motion_covariance) * someMotion();
        const double true_rho = (1.0 + params_.uncertainty.noise.depth_std * normal()) / depth;
        Eigen::Vector2d flow = pixelOf(motion, u, v, 1.0 / true_rho) - Eigen::Vector2d(u, v);
        const double sigma =
            params_.uncertainty.noise.flow_std + params_.uncertainty.noise.flow_std_relative * flow.norm();
        flow += sigma * Eigen::Vector2d(normal(), normal());
        input.depth.at<float>(v, u) = static_cast<float>(depth);
        input.flow.at<cv::Vec2f>(v, u) =
            cv::Vec2f(static_cast<float>(flow.x()), static_cast<float>(flow.y()));
      }
    }
    return input;
  }

 private:
  double normal() { return normal_(random_); }
  Eigen::Isometry3d smallMotion(const Matrix6& covariance) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    if (covariance.isZero()) return motion;
    Vector6 draw;
    for (int i = 0; i < 6; ++i) draw[i] = normal();
    const Vector6 change = covariance.llt().matrixL() * draw;
    const Eigen::Vector3d omega = change.head<3>();
    motion.linear() = Eigen::AngleAxisd(omega.norm(), omega.normalized()).toRotationMatrix();
    motion.translation() = change.tail<3>();
    return motion;
  }

  MotionParams params_;
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
};

MotionParams exactModel() {
  MotionParams params;
  params.score = MotionScore::kUncertainty;
  params.uncertainty.noise.flow_std = 0.5;
  params.uncertainty.noise.flow_std_relative = 0.02;
  params.uncertainty.noise.depth_std = 0.05;
  params.uncertainty.false_alarm = 1e-5;
  params.uncertainty.hysteresis_ratio = params.uncertainty.min_scale = 1.0;
  params.cleanup.opening = params.cleanup.closing = 0;
  params.predicted_in_view = false;
  return params;
}

double shareAbove(const MotionResult& result) {
  return static_cast<double>(cv::countNonZero(result.mask)) / static_cast<double>(result.valid_count);
}

TEST(UncertaintyScore, FalseAlarmsOfAStaticWorldAreAsManyAsAskedFor) {
  for (const Matrix6& covariance : {Matrix6(Matrix6::Zero()), someCovariance(0.002, 0.02)}) {
    for (const double wanted : {0.05, 0.01}) {
      MotionParams params = exactModel();
      params.uncertainty.false_alarm = wanted;
      MotionSegmenter segmenter(params);
      const MotionResult& result = segmenter.segment(StaticWorld(params).input(covariance));
      EXPECT_NEAR(result.median, terms::chiMedian(2), 0.02);
      EXPECT_NEAR(shareAbove(result), wanted, 0.15 * wanted);
    }
  }
}

TEST(UncertaintyScore, ThresholdGrowsWithWhatTheModelLeavesOut) {
  MotionParams params = exactModel();
  params.uncertainty.false_alarm = 0.01;
  const MotionInput input = StaticWorld(params).input(Matrix6::Zero());
  params.uncertainty.noise.flow_std /= 4.0;
  params.uncertainty.noise.flow_std_relative /= 4.0;
  params.uncertainty.noise.depth_std /= 4.0;  // four times too sure of everything
  MotionSegmenter segmenter(params);
  const MotionResult& result = segmenter.segment(input);
  EXPECT_NEAR(result.median, 4.0 * terms::chiMedian(2), 0.1);
  EXPECT_NEAR(shareAbove(result), 0.01, 0.003);
}

TEST(UncertaintyScore, ThresholdFallsWithImagesBetterThanTheModel) {
  MotionParams params = exactModel();
  params.uncertainty.false_alarm = 0.01;
  const MotionInput input = StaticWorld(params).input(Matrix6::Zero());
  params.uncertainty.noise.flow_std *= 4.0;
  params.uncertainty.noise.flow_std_relative *= 4.0;
  params.uncertainty.noise.depth_std *= 4.0;  // four times too doubtful of everything
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
  params.uncertainty.min_scale = 0.1;
  MotionSegmenter segmenter(params);
  const MotionResult& result = segmenter.segment(input);
  EXPECT_NEAR(result.scale, 0.25, 0.01);
  EXPECT_NEAR(shareAbove(result), 0.01, 0.003);
  params.uncertainty.min_scale = 0.5;
  EXPECT_EQ(MotionSegmenter(params).segment(input).scale, 0.5);
}

/// Of a camera that drives towards a wall 20 m away, 1 m.
MotionInput wall() {
  MotionInput input;
  input.camera = {500.0, 500.0, 159.5, 119.5, 320, 240};
  input.T_current_from_previous.translation() = Eigen::Vector3d(0.0, 0.0, -1.0);
  input.depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(20.0));
  input.flow = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  return input;
}

void move(MotionInput& input, const cv::Rect& part, cv::Vec2f flow) {
  for (int v = part.y; v < part.y + part.height; ++v)
    for (int u = part.x; u < part.x + part.width; ++u) input.flow.at<cv::Vec2f>(v, u) += flow;
}

// At (260, 120) the focus of expansion is to the left: depth moves pixels sideways only.
TEST(UncertaintyScore, TellsAnErrorOfDepthFromMotionAcrossIt) {
  MotionParams params = exactModel();
  params.uncertainty.noise.depth_std = 0.5;
  MotionInput along = wall();
  move(along, {250, 110, 20, 20}, {6.0F, 0.0F});
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(along).mask), 0);
  MotionInput across = wall();
  move(across, {250, 110, 20, 20}, {0.0F, 6.0F});
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(across).mask), 400);
}

TEST(UncertaintyScore, LooksAtTheNoiseOfEveryPixel) {
  MotionParams params = exactModel();
  MotionInput input = wall();
  move(input, {250, 110, 20, 20}, {0.0F, 6.0F});
  input.fb_error = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0.0));
  input.depth_std = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0.05));
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 400);
  params.uncertainty.noise.fb_error_weight = 1.0;
  input.fb_error(cv::Rect(250, 110, 20, 10)).setTo(10.0);
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 200);
  move(input, {250, 120, 20, 10}, {6.0F, -6.0F});  // now along the direction of depth
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 200);
  input.depth_std(cv::Rect(250, 120, 20, 10)).setTo(1.0);
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
  // What is not a number says nothing: the parameter holds.
  input.depth_std(cv::Rect(250, 120, 20, 10)).setTo(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 200);
  params.uncertainty.noise.depth_std = 1.0;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
}

TEST(UncertaintyScore, DepthSeenInTheSecondImageIsAThirdComponent) {
  MotionParams params = exactModel();
  params.uncertainty.next_depth_std = 0.02;
  MotionInput input = wall();
  input.next_depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(19.0));
  input.next_depth(cv::Rect(200, 60, 40, 40)).setTo(24.0);  // 13 sigma
  EXPECT_GT(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 1200);
  params.uncertainty.next_depth_std = 0.5;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
}

TEST(RadarEvidence, StaticReturnsLowerTheScoreButNotWhereOneMoves) {
  MotionParams params = exactModel();
  params.radar.dynamic_gain = 0.0;
  MotionInput input = wall();
  move(input, {130, 100, 60, 40}, {0.0F, 3.5F});  // about six sigma
  input.static_points = {{{0.0F, 0.0F, 20.0F}}};  // 50 px wide, 50 px high around the middle
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 2400);
  params.radar.static_gain = 1.0;
  EXPECT_LT(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 1200);
  params.radar.dynamic_gain = 1.0;
  input.dynamic_points = input.static_points;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 2400);
}

TEST(RadarEvidence, FarFootprintsAreAsWideAsTheBearingIsUncertain) {
  MotionParams params = exactModel();
  MotionInput input = wall();
  input.depth.setTo(60.0);
  input.flow = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  move(input, {110, 100, 100, 30}, {0.0F, 1.5F});  // about three sigma: too little by itself
  input.dynamic_points = {{{0.0F, 0.0F, 60.0F}}};
  const int narrow = cv::countNonZero(MotionSegmenter(params).segment(input).mask);
  params.radar.azimuth_std = 0.05;  // 3 m instead of 1 m
  const int wide = cv::countNonZero(MotionSegmenter(params).segment(input).mask);
  EXPECT_GT(narrow, 100);
  EXPECT_NEAR(static_cast<double>(wide) / narrow, 3.0, 0.3);
}

TEST(RadarEvidence, CountsWhereTheFlowMayBeThatOfWhatTheReturnIsOf) {
  MotionParams params = exactModel();
  params.uncertainty.noise.flow_std = 0.3;
  params.uncertainty.false_alarm = 0.01;
  MotionInput input = wall();
  input.depth.setTo(60.0);
  input.duration = 0.1;
  const cv::Mat background = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  const auto marked = [&](const cv::Mat& flow_above, float speed) {
    input.flow = background.clone();
    const cv::Rect above(150, 95, 20, 20);  // within the footprint: nothing moves up or down by itself
    flow_above(above).copyTo(input.flow(above));
    input.dynamic_points = {{{0.0F, 0.0F, 20.0F}, speed}};
    return cv::countNonZero(MotionSegmenter(params).segment(input).mask);
  };
  // Ahead, as fast as the vehicle, which moves 1 m in this time: its flow is zero, that of the wall is not.
  const cv::Mat still = cv::Mat::zeros(background.size(), CV_32FC2);
  EXPECT_GT(marked(still, 10.0F), 80);
  // As far from that of the wall, the other way: nothing that keeps its distance has it.
  EXPECT_EQ(marked(2.0 * background, 10.0F), 0);
  EXPECT_GT(marked(2.0 * background, std::numeric_limits<float>::quiet_NaN()), 80);
  params.radar.dynamic_gain = 0.0;
  EXPECT_EQ(marked(still, 10.0F), 0);
}

TEST(Hysteresis, RegionsWithTooFewSeedsDoNotCount) {
  MotionParams params = exactModel();
  params.uncertainty.false_alarm = 0.05;
  MotionInput input = wall();
  move(input, {40, 40, 60, 20}, {0.0F, 1.7F});    // weak
  move(input, {40, 40, 18, 20}, {0.0F, 4.0F});    // with a strong end
  move(input, {200, 180, 60, 20}, {0.0F, 1.7F});  // weak only
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 2400);
  params.uncertainty.hysteresis_ratio = 2.0;
  const cv::Mat mask = MotionSegmenter(params).segment(input).mask.clone();
  EXPECT_EQ(cv::countNonZero(mask), 1200);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(40, 40, 60, 20))), 1200);
  params.uncertainty.seed_share = 0.5;
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 0);
}

/// Of a camera 1.5 m above a plane, which drives ahead by 1 m: the ground up to the horizon, and sky.
MotionInput street() {
  MotionInput input;
  input.camera = {500.0, 500.0, 159.5, 119.5, 320, 240};
  input.T_current_from_previous.translation() = Eigen::Vector3d(0.0, 0.0, -1.0);
  GroundPlane ground;
  ground.T_base_from_camera.linear() << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  ground.T_base_from_camera.translation().z() = 1.5;
  input.depth = groundDepth(input.camera, ground.T_base_from_camera, 0.0, 0.0, 100.0);
  input.depth.setTo(40.0, ~(input.depth == input.depth));
  input.flow = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  input.ground = ground;
  return input;
}

/// A part of the image that shows what stands at another depth, m.
void stand(MotionInput& input, const cv::Rect& part, double depth) {
  const cv::Mat there(input.depth.size(), CV_32FC1, cv::Scalar(depth));
  expectedFlow(input.camera, input.T_current_from_previous, there)(part).copyTo(input.flow(part));
}

int marked(const MotionParams& params, const MotionInput& input, const cv::Rect& part,
           const MotionInput* before = nullptr) {
  return cv::countNonZero(MotionSegmenter(params).segment(input, before).mask(part));
}

TEST(Hysteresis, WhatMayStandBeforeTheGroundIsNoSeed) {
  MotionParams params = exactModel();
  params.uncertainty.noise.flow_std = 0.1;
  params.uncertainty.hysteresis_ratio = 1.5;
  const cv::Rect near(240, 140, 30, 40), far(60, 20, 30, 40), sky(200, 20, 30, 40);
  MotionInput input = street();
  stand(input, near, 6.0);  // the ground is 12 to 37 m away there
  stand(input, far, 8.0);
  stand(input, sky, 5000.0);
  for (const cv::Rect& part : {near, far, sky}) EXPECT_EQ(marked(params, input, part), 0);
  MotionInput measured = input;
  measured.ground.reset();
  for (const cv::Rect& part : {near, far, sky}) EXPECT_GT(marked(params, measured, part), 1100);
  // What drives ahead as fast would have to stand behind the ground; what crosses, nowhere.
  input = street();
  input.flow(near).setTo(cv::Scalar(0.0, 0.0));
  move(input, far, {0.0F, 6.0F});
  EXPECT_GT(marked(params, input, near), 900);
  EXPECT_GT(marked(params, input, far), 1100);
}

// Whoever judges a pixel says whether a static world explains it: also the previous image alone.
TEST(Hysteresis, BothPairsTellWhatMayStandBeforeTheGround) {
  MotionParams params = exactModel();
  params.uncertainty.noise.flow_std = 0.1;
  params.uncertainty.hysteresis_ratio = 1.5;
  const cv::Rect near(240, 140, 30, 40);
  const MotionInput still = street();
  const auto lookedBack = [&still](cv::Rect part, double depth, float down) {
    MotionInput before = still;
    before.T_current_from_previous = still.T_current_from_previous.inverse();
    before.flow = expectedFlow(before.camera, before.T_current_from_previous, before.depth);
    stand(before, part, depth);
    move(before, part, {0.0F, down});
    return before;
  };
  const MotionInput stands = lookedBack(near, 6.0, 0.0F), crosses = lookedBack(near, 6.0, 6.0F);
  MotionInput left = still;  // the view
  left.flow(near).setTo(cv::Scalar::all(std::nan("")));
  EXPECT_EQ(marked(params, left, near, &stands), 0);
  EXPECT_GT(marked(params, left, near, &crosses), 1100);
  MotionInput seen = still;
  stand(seen, near, 6.0);
  EXPECT_EQ(marked(params, seen, near, &stands), 0);
  EXPECT_GT(marked(params, seen, near, &crosses), 1100);
}

TEST(Hysteresis, WhatIsDrawnTooFarAwayHidesNoMover) {
  MotionParams params = exactModel();
  params.uncertainty.noise.flow_std = 0.1;
  params.uncertainty.hysteresis_ratio = 1.5;
  const cv::Rect houses(0, 0, 320, 150), ahead(240, 170, 30, 40);
  MotionInput input = street();
  stand(input, houses, 34.0);  // drawn at 40 m, over most of the image
  input.flow(ahead).setTo(cv::Scalar(0.0, 0.0));
  EXPECT_EQ(marked(params, input, houses), 0);
  EXPECT_GT(marked(params, input, ahead), 1000);
  // Where all flow is wrong, also across, nobody knows.
  cv::Mat noise(input.flow.size(), CV_32FC2);
  cv::theRNG().state = 1;
  cv::randn(noise, cv::Scalar::all(0.0), cv::Scalar::all(4.0));
  input.flow += noise;
  EXPECT_EQ(marked(params, input, ahead), 0);
}

TEST(UncertaintyScore, FlowOfNoTextureSaysLittle) {
  const MotionParams params = exactModel();
  MotionInput input = wall();
  move(input, {250, 110, 20, 20}, {0.0F, 6.0F});
  input.texture_std = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0.1));
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 400);
  input.texture_std(cv::Rect(250, 110, 20, 10)).setTo(10.0);
  EXPECT_EQ(cv::countNonZero(MotionSegmenter(params).segment(input).mask), 200);
}

TEST(UncertaintyScore, ParametersThatMakeNoSenseAreRefused) {
  const auto refused = [](auto change, const char* name) {
    MotionParams params;
    change(params);
    test::expectRefusal([&] { validate(params); }, {name});
  };
  refused([](MotionParams& p) { p.uncertainty.noise.flow_std = p.uncertainty.noise.flow_std_relative = 0.0; },
          "flow_std");
  refused([](MotionParams& p) { p.uncertainty.hysteresis_ratio = 0.5; }, "hysteresis_ratio");
  MotionInput input = wall();
  input.fb_error = cv::Mat(4, 4, CV_32FC1);
  test::expectRefusal([&] { MotionSegmenter().segment(input); }, {"fb_error"});
}

}  // namespace
}  // namespace radar_dot
