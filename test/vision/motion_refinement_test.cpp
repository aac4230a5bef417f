// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <random>

#include "fixtures/camera_mount.h"
#include "fixtures/refusal.h"
#include "radar_dot/common/base_motion.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const CameraIntrinsics kCamera{400.0, 400.0, 199.5, 111.5, 400, 224};

/// 1.5 m above the ground.
Eigen::Isometry3d mount() { return test::lookingAhead({1.7, 0.0, 1.5}); }

Eigen::Isometry3d moved(const Vector6& change, const Eigen::Isometry3d& motion) {
  Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d omega = change.head<3>();
  if (omega.norm() > 0.0)
    small.linear() = Eigen::AngleAxisd(omega.norm(), omega.normalized()).toRotationMatrix();
  small.translation() = change.tail<3>();
  return small * motion;
}

/// Ground, and houses 30 m away above it, seen by a camera that drives 4 m and turns a little.
MotionInput street(const Eigen::Isometry3d& true_motion, const GroundPlane& ground) {
  MotionInput input;
  input.camera = kCamera;
  input.pixel_scale = 2.0;
  input.depth =
      groundDepth(kCamera, ground.T_base_from_camera, ground.params.height, ground.params.pitch, 30.0);
  cv::patchNaNs(input.depth, 30.0);
  input.flow = expectedFlow(kCamera, true_motion, input.depth);
  return input;
}

Eigen::Isometry3d drive() {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()).toRotationMatrix();
  motion.translation() = Eigen::Vector3d(0.05, 0.0, -4.0);
  return motion;
}

Matrix6 prior() {
  Vector6 deviations;
  deviations << 0.02, 0.01, 0.02, 0.1, 0.1, 0.1;
  return deviations.cwiseAbs2().asDiagonal();
}

GroundPlane flat() { return {mount(), {}}; }

Vector6 errorOf(const RefinedMotion& refined, const Eigen::Isometry3d& truth) {
  const Eigen::Isometry3d rest = truth * refined.T_current_from_previous.inverse();
  const Eigen::AngleAxisd rotation(rest.linear());
  Vector6 error;
  error << rotation.angle() * rotation.axis(), rest.translation();
  return error;
}

TEST(RefineMotion, FindsPitchAndRollThatRadarDoesNotKnow) {
  Vector6 change;
  change << 0.015, 0.0, -0.01, 0.0, 0.0, 0.0;  // pitch 0.86 degrees, roll -0.57
  MotionInput input = street(moved(change, drive()), flat());
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  const RefinedMotion refined = refineMotion(input);
  EXPECT_GT(refined.pixels, 700U);
  EXPECT_LT(errorOf(refined, moved(change, drive())).head<3>().norm(), 1e-3);
  EXPECT_NEAR(refined.correction[0], 0.015, 1e-3);
  EXPECT_NEAR(refined.correction[2], -0.01, 1e-3);
  EXPECT_LT(std::sqrt(refined.covariance(0, 0)), 0.005);  // it knows that it has learnt something
}

TEST(RefineMotion, MoversDoNotMatter) {
  Vector6 change;
  change << 0.01, 0.002, 0.005, 0.0, 0.02, 0.0;
  MotionInput input = street(moved(change, drive()), flat());
  for (int v = 80; v < 140; ++v)
    for (int u = 40; u < 200; ++u)
      input.flow.at<cv::Vec2f>(v, u) += cv::Vec2f(12.0F, 3.0F);  // a tenth of all
  input.flow.at<cv::Vec2f>(20, 20)[0] = std::numeric_limits<float>::quiet_NaN();
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  EXPECT_LT(errorOf(refineMotion(input), moved(change, drive())).head<3>().norm(), 2e-3);
}

TEST(RefineMotion, WhatIsExactStays) {
  Vector6 change;
  change << 0.01, 0.01, 0.0, 0.0, 0.0, 0.3;
  MotionInput input = street(moved(change, drive()), flat());
  input.T_current_from_previous = drive();
  Vector6 deviations;
  deviations << 0.02, 0.0, 0.0, 0.0, 0.0, 0.0;  // nothing but pitch is uncertain
  input.motion_covariance = deviations.cwiseAbs2().asDiagonal();
  const RefinedMotion refined = refineMotion(input);
  EXPECT_GT(std::abs(refined.correction[0]), 0.003);
  EXPECT_LT(refined.correction.tail<5>().norm(), 1e-4);
  input.motion_covariance.setZero();
  EXPECT_LT(refineMotion(input).correction.norm(), 1e-4);
}

// By 40 of its standard deviations: a gyroscope that has failed, or a twist of another time.
TEST(RefineMotion, AYawRateThatTheImageContradictsGivesWay) {
  constexpr double kInterval = 0.1, kYawRate = 0.24;  // s, rad/s
  const auto motion = [](double yaw_rate) {
    return staticPointMotion(mount(), baseMotion({10.0, 0.0, 0.0}, {0.0, 0.0, yaw_rate}, kInterval));
  };
  for (const double given : {0.0, kYawRate}) {
    MotionInput input = street(motion(kYawRate), flat());
    for (int v = 80; v < 140; ++v)
      for (int u = 40; u < 200; ++u) input.flow.at<cv::Vec2f>(v, u) += cv::Vec2f(12.0F, 3.0F);
    input.T_current_from_previous = motion(given);
    input.motion_covariance = cameraCovariance(mount(), baseMotionCovariance({}, kInterval));
    const RefinedMotion refined = refineMotion(input);
    const Vector6 error = errorOf(refined, motion(kYawRate));
    EXPECT_LT(error.head<3>().norm() / kInterval, 0.01) << given;
    EXPECT_LT(error.tail<3>().norm() / kInterval, 0.1) << given;  // the camera moves sideways as it turns
  }
}

// Whatever fills the image, as a lorry that passes at a red light.
TEST(RefineMotion, AVehicleThatStandsDoesNotTurn) {
  const Eigen::Isometry3d standing = Eigen::Isometry3d::Identity();
  MotionInput input = street(standing, flat());
  input.flow(cv::Rect(0, 0, 280, kCamera.height)) += cv::Scalar(8.0, 0.0);  // seven tenths
  input.T_current_from_previous = standing;
  constexpr double kInterval = 0.1;
  input.motion_covariance = cameraCovariance(mount(), baseMotionCovariance({}, kInterval));
  EXPECT_TRUE(refineMotion(input).T_current_from_previous.isApprox(standing));
  // Nor when a yaw rate says so, by 40 of its standard deviations.
  input = street(standing, flat());
  input.motion_covariance = cameraCovariance(mount(), baseMotionCovariance({}, kInterval));
  input.T_current_from_previous.linear() =
      Eigen::AngleAxisd(0.024, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_LT(errorOf(refineMotion(input), standing).head<3>().norm(), 1e-3);
}

TEST(RefineMotion, NoiseStaysWithinTheCovarianceItGives) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0.0F, 1.0F);
  double sum = 0.0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    MotionInput input = street(drive(), flat());
    FlowDepthNoise noise_params;
    noise_params.flow_std = 2.0;  // 1 px of the grid
    noise_params.flow_std_relative = 0.0;
    RefinementParams params;
    params.independent_pixels = 1e7;  // they are independent
    for (auto& flow : cv::Mat_<cv::Vec2f>(input.flow)) flow += cv::Vec2f(noise(random), noise(random));
    input.T_current_from_previous = drive();
    input.motion_covariance = prior();
    const RefinedMotion refined = refineMotion(input, std::nullopt, noise_params, params);
    const Vector6 error = errorOf(refined, drive());
    sum += error.dot(refined.covariance.llt().solve(error));
  }
  EXPECT_LT(sum / kTrials, 9.0);  // 6 degrees of freedom
  EXPECT_GT(sum / kTrials, 0.5);
}

TEST(RefineMotion, FindsThePitchOfTheGroundAhead) {
  const GroundPlane truth{mount(), {0.015, 0.02, {}}};
  MotionInput input = street(drive(), truth);
  input.depth = groundDepth(kCamera, mount(), 0.0, 0.0, 30.0);  // what is thought: flat
  cv::patchNaNs(input.depth, 30.0);
  input.T_current_from_previous = drive();
  Vector6 deviations = Vector6::Zero();
  input.motion_covariance = deviations.asDiagonal();
  const RefinedMotion refined = refineMotion(input, flat());
  ASSERT_TRUE(refined.ground);
  EXPECT_NEAR(refined.ground->params.pitch, 0.015, 0.004);
  EXPECT_NEAR(refined.ground->params.height, 0.02, 0.03);
  const cv::Mat depth = replaceGroundDepth(input.depth, kCamera, flat(), *refined.ground, 30.0);
  const cv::Mat wanted = groundDepth(kCamera, mount(), 0.02, 0.015, 30.0);
  EXPECT_NEAR(depth.at<float>(200, 100), wanted.at<float>(200, 100), 0.25);
  EXPECT_FLOAT_EQ(depth.at<float>(10, 10), 30.0F);  // a house is no ground
}

// What the image has told of the ground makes its depth more certain; houses stay as they are.
TEST(RefineMotion, GroundThatTheImageHasSeenIsMoreCertain) {
  MotionInput input = street(drive(), flat());
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  const GroundUncertainty before;
  RefinedMotion refined = refineMotion(input, flat());
  EXPECT_GT(refined.ground->params.uncertainty.pitch_std, 0.0);
  EXPECT_LT(refined.ground->params.uncertainty.pitch_std, 0.9 * before.pitch_std);
  EXPECT_LE(refined.ground->params.uncertainty.height_std, before.height_std);
  EXPECT_EQ(refined.ground->params.uncertainty.relative_std, before.relative_std);

  const cv::Mat stds(input.depth.size(), CV_32FC1, cv::Scalar(0.5));
  const cv::Mat exchanged = replaceGroundStd(stds, input.depth, kCamera, flat(), refined);
  const cv::Mat wanted = groundRelativeStd(kCamera, mount(), refined.ground->params);
  EXPECT_FLOAT_EQ(exchanged.at<float>(200, 100), wanted.at<float>(200, 100));
  EXPECT_LT(exchanged.at<float>(200, 100), 0.3F);
  EXPECT_FLOAT_EQ(exchanged.at<float>(10, 10), 0.5F);
  // Too few pixels tell nothing.
  input.depth.setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(refineMotion(input, flat()).ground->params.uncertainty.pitch_std, before.pitch_std);
}

// Noise may bring a point right before the camera, or beyond.
TEST(RefineMotion, StandsDepthsThatAreNone) {
  Vector6 change;
  change << 0.01, 0.0, 0.0, 0.0, 0.0, 0.0;
  MotionInput input = street(moved(change, drive()), flat());
  for (int i = 0; i < 60; ++i) {
    input.depth.row(3 * i).colRange(0, 200).setTo(std::pow(10.0, -0.5 * i));
    input.depth.at<float>(3 * i, 300) = 4.0F + 1e-6F * static_cast<float>(i);  // just where the camera goes
  }
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  const RefinedMotion refined = refineMotion(input);
  EXPECT_TRUE(refined.T_current_from_previous.matrix().allFinite());
  EXPECT_LT(errorOf(refined, moved(change, drive())).head<3>().norm(), 5e-3);
}

// Depth of one half of the image is wrong by half; only what it says of itself tells which.
TEST(RefineMotion, LooksAtTheUncertaintyOfEveryDepth) {
  MotionInput input = street(drive(), flat());
  input.depth.colRange(0, 200) *= 1.5;
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  FlowDepthNoise noise;
  noise.depth_std = 0.01;
  RefinementParams params;
  params.kernel_width = 1000.0;  // all pixels count
  const double misled = errorOf(refineMotion(input, std::nullopt, noise, params), drive()).norm();
  input.depth_std = cv::Mat(input.depth.size(), CV_32FC1, cv::Scalar(0.01));
  input.depth_std.colRange(0, 200).setTo(2.0);
  EXPECT_LT(errorOf(refineMotion(input, std::nullopt, noise, params), drive()).norm(), 0.3 * misled);
  // One pixel that says nothing must not spoil the others: the parameter holds.
  input.depth_std.colRange(200, 300).setTo(std::numeric_limits<double>::quiet_NaN());
  const RefinedMotion refined = refineMotion(input, std::nullopt, noise, params);
  EXPECT_LT(errorOf(refined, drive()).norm(), 0.3 * misled);
  EXPECT_GT(refined.correction.norm(), 0.0);
}

// A base that pitches between the images sees the same ground under another pitch.
TEST(RefineInput, TheGroundOfTheSecondImageTurnsWithTheMotion) {
  constexpr double kNoseDown = 0.02, kFar = 30.0;  // rad, m
  Eigen::Isometry3d T_first_from_second = Eigen::Isometry3d::Identity();
  T_first_from_second.linear() = Eigen::AngleAxisd(kNoseDown, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T_first_from_second.translation().x() = 4.0;
  const Eigen::Isometry3d motion = staticPointMotion(mount(), T_first_from_second);
  MotionInput input = street(motion, flat());
  input.T_current_from_previous = motion;  // without a covariance it stays
  input.next_depth = groundDepth(kCamera, mount(), 0.0, 0.0, kFar);
  refineInput(input, flat(), kFar);
  const cv::Mat expected = groundDepth(kCamera, mount(), 0.0, kNoseDown, kFar);
  for (const int row : {150, 180, 220})
    EXPECT_NEAR(input.next_depth.at<float>(row, 200) / expected.at<float>(row, 200), 1.0, 0.01) << row;
}

TEST(RefineMotion, TooLittleChangesNothing) {
  MotionInput input = street(drive(), flat());
  input.T_current_from_previous = drive();
  input.motion_covariance = prior();
  input.depth.setTo(std::numeric_limits<float>::quiet_NaN());
  const RefinedMotion refined = refineMotion(input);
  EXPECT_EQ(refined.pixels, 0U);
  EXPECT_TRUE(refined.T_current_from_previous.isApprox(drive()));
  RefinementParams params;
  params.stride = 0;
  test::expectRefusal([&] { refineMotion(input, std::nullopt, {}, params); }, {"stride"});
}

// A turn of the vehicle about its base moves the camera, which sits ahead of it, sideways.
TEST(CameraCovariance, CarriesTheLeverArm) {
  Matrix6 base = Matrix6::Zero();
  base(2, 2) = 1e-4;  // yaw, 0.01 rad
  base(3, 3) = 0.04;  // ahead, 0.2 m
  const Matrix6 camera = cameraCovariance(mount(), base);
  EXPECT_NEAR(camera(1, 1), 1e-4, 1e-12);                 // about the camera's y axis
  EXPECT_NEAR(camera(3, 3), 1e-4 * 1.7 * 1.7, 1e-9);      // sideways by the lever arm
  EXPECT_NEAR(camera(5, 5), 0.04, 1e-12);                 // ahead is z
  EXPECT_NEAR(std::abs(camera(1, 3)), 1e-4 * 1.7, 1e-9);  // and both are one
  // The same by moving a point: base (yaw 0.01, ahead 0.2) against camera.
  const Eigen::Vector3d seen(0.5, -0.2, 9.0);
  Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
  small.linear() = Eigen::AngleAxisd(1e-6, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d expected = (mount().inverse() * small * mount() * seen - seen) * 1e4;  // for 0.01 rad
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) jacobian.col(i) = Eigen::Vector3d::Unit(i).cross(seen);
  base(3, 3) = 0.0;
  const Eigen::Matrix3d spread = jacobian * cameraCovariance(mount(), base) * jacobian.transpose();
  EXPECT_LT((spread - expected * expected.transpose()).norm(), 1e-6);
}

TEST(MotionUncertainty, OfATwistThatIsLessCertainThanConfigured) {
  MotionUncertainty configured;
  configured.forward_velocity_std = 0.1;
  configured.lateral_velocity_std = 0.06;
  configured.yaw_rate_std = 0.006;
  Matrix6 twist = Matrix6::Zero();
  twist(0, 0) = 0.25 * 0.25;
  twist(1, 1) = 1e6;  // not observed
  twist(5, 5) = 0.02 * 0.02;
  const MotionUncertainty wide = motionUncertainty(configured, twist, /*has_rotation=*/false);
  EXPECT_NEAR(wide.forward_velocity_std, 0.25, 1e-12);
  EXPECT_EQ(wide.lateral_velocity_std, 0.06);
  EXPECT_NEAR(wide.yaw_rate_std, 0.02, 1e-12);
  EXPECT_EQ(motionUncertainty(configured, twist, /*has_rotation=*/true).yaw_rate_std, 0.006);
  twist(0, 0) = 0.05 * 0.05;
  EXPECT_EQ(motionUncertainty(configured, twist, false).forward_velocity_std, 0.1);
}

}  // namespace
}  // namespace radar_dot
