// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/mask_pipeline.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "fixtures/refusal.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kStep = 0.1;  // s between images
const cv::Rect kPatch(100, 40, 20, 10);

/// A camera that drives towards a wall, 1 m from each image to the next, 21 m away at image 0.
class Drive {
 public:
  static cv::Mat depthAt(int image) { return {kHeight, kWidth, CV_32FC1, cv::Scalar(21.0 - image)}; }
  static Eigen::Isometry3d mount() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T.translation() << 1.5, 0.0, 1.6;
    return T;
  }
  /// Of two images; the patch moves by `down` px more than a static world.
  static MaskPair pair(int first, int second, float down = 0.0F) {
    MaskPair pair;
    pair.first_time = kStep * first;
    pair.second_time = kStep * second;
    pair.camera = {250.0, 250.0, 79.5, 59.5, kWidth, kHeight};
    pair.depth = depthAt(first);
    pair.next_depth = depthAt(second);
    pair.T_base_from_camera = mount();
    pair.T_first_from_second.translation().x() = second - first;
    pair.flow.flow =
        expectedFlow(pair.camera, staticPointMotion(mount(), pair.T_first_from_second), pair.depth);
    for (int v = kPatch.y; v < kPatch.y + kPatch.height; ++v)
      for (int u = kPatch.x; u < kPatch.x + kPatch.width; ++u) pair.flow.flow.at<cv::Vec2f>(v, u)[1] += down;
    return pair;
  }
  static MaskPipelineParams params() {
    MaskPipelineParams params;
    params.motion.score = MotionScore::kUncertainty;
    params.motion.uncertainty.noise.flow_std = 0.5;
    params.motion.uncertainty.noise.depth_std = 0.05;
    params.motion.cleanup.opening = params.motion.cleanup.closing = 0;
    params.motion.uncertainty.hysteresis_ratio = params.motion.uncertainty.min_scale = 1.0;
    return params;
  }
};

/// Image 0 to 1, whose patch moves, the flow back, then image 1 to 2, whose patch has no flow of its own.
MaskOutcome secondOf(
    MaskPipeline& pipeline, float moves_back = 10.0F, const std::function<void()>& between = [] {}) {
  pipeline.process(Drive::pair(0, 1, 10.0F));
  pipeline.addBackward(kStep, 0.0, Drive::pair(1, 0, moves_back).flow);
  between();
  MaskPair next = Drive::pair(1, 2);
  next.flow.flow(kPatch).setTo(cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
  return pipeline.process(next);
}

TEST(MaskPipeline, LooksBackAlongTheFlowBackOfThePreviousPair) {
  MaskPipelineParams params = Drive::params();
  MaskPipeline alone(params);
  EXPECT_EQ(cv::countNonZero(secondOf(alone).result.mask), 0);
  params.look_back = true;
  MaskPipeline pipeline(params);
  const MaskOutcome outcome = secondOf(pipeline);
  EXPECT_TRUE(outcome.looked_back);
  EXPECT_EQ(cv::countNonZero(outcome.result.mask(kPatch)), kPatch.area());
  EXPECT_EQ(cv::countNonZero(outcome.result.mask), kPatch.area());
}

// The patch moves on by its own height, and uncovers the wall behind, which leaves the view before the second
// image.
TEST(MaskPipeline, WhatAMoverUncoversDoesNotMove) {
  MaskPipelineParams params = Drive::params();
  params.look_back = true;
  MaskPipeline pipeline(params);
  const cv::Rect moved(kPatch.x + 3, kPatch.y + kPatch.height + 1, kPatch.width - 6, kPatch.height - 2);
  const cv::Rect wall(kPatch.x + 3, kPatch.y + 1, kPatch.width - 6, kPatch.height - 2);
  const cv::Rect both = wall | moved;
  pipeline.process(Drive::pair(0, 1, 10.0F));
  FlowField back = Drive::pair(1, 0).flow;
  for (int v = both.y; v < both.y + both.height; ++v)
    for (int u = both.x; u < both.x + both.width; ++u) back.flow.at<cv::Vec2f>(v, u)[1] -= 10.0F;
  back.fb_error = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1));
  back.fb_error(wall).setTo(10.0);
  pipeline.addBackward(kStep, 0.0, back);
  MaskPair next = Drive::pair(1, 2);
  next.flow.flow(both).setTo(cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
  const MaskOutcome outcome = pipeline.process(next);
  EXPECT_EQ(cv::countNonZero(outcome.result.mask(moved)), moved.area());
  EXPECT_EQ(cv::countNonZero(outcome.result.mask(wall)), 0);
  EXPECT_EQ(cv::countNonZero(outcome.result.valid(wall)), 0) << "nothing is known of it";
}

// The camera stands. Something hides a patch of the wall in the third image, and lends it its flow, both
// ways.
TEST(MaskPipeline, WhatThePreviousImageShowsStands) {
  cv::Mat wall(kHeight, kWidth, CV_8UC1), other = wall.clone();
  cv::theRNG().state = 5;
  cv::randu(wall, 0, 256);
  cv::randu(other, 0, 256);
  cv::Mat hidden = wall.clone();
  other(kPatch).copyTo(hidden(kPatch));
  const auto standing = [&wall](int first) {
    MaskPair pair = Drive::pair(first, first + 1);
    pair.T_first_from_second.setIdentity();
    pair.depth = pair.next_depth = Drive::depthAt(0);
    pair.flow.flow.setTo(cv::Scalar::all(0.0));
    pair.flow.grey = wall.clone();
    return pair;
  };
  const auto marked = [&](bool look_back) {
    MaskPipelineParams params = Drive::params();
    params.look_back = look_back;
    params.motion.cleanup.border = 4;
    MaskPipeline pipeline(params);
    const MaskPair first = standing(0);
    pipeline.process(first);
    FlowField back = standing(1).flow;
    back.flow(kPatch).setTo(cv::Scalar(0.0, -10.0));
    pipeline.addBackward(kStep, 0.0, back);
    MaskPair next = standing(1);
    next.flow.flow(kPatch).setTo(cv::Scalar(0.0, 10.0));
    next.flow.second_grey = hidden;
    cv::Mat(first.flow.grey).setTo(0);  // what the pipeline keeps is its own
    return cv::countNonZero(pipeline.process(next).result.mask);
  };
  EXPECT_GT(marked(false), kPatch.area() / 2);
  EXPECT_EQ(marked(true), 0);
}

TEST(MaskPipeline, RemembersThePreviousMask) {
  MaskPipelineParams params = Drive::params();
  params.memory = 10.0;
  MaskPipeline pipeline(params);
  const MaskOutcome outcome = secondOf(pipeline, 0.0F);
  EXPECT_FALSE(outcome.looked_back);
  EXPECT_GT(cv::countNonZero(outcome.result.mask(kPatch)), kPatch.area() / 4);
  params.memory = 0.01;
  MaskPipeline forgetful(params);
  EXPECT_EQ(cv::countNonZero(secondOf(forgetful, 0.0F).result.mask), 0);
}

// The wall is said to be twice as far as it is; the flow tells.
MaskOutcome withDepthTwiceAsFar(const MaskPipelineParams& params, bool wants_motion_depth) {
  MaskPipeline pipeline(params);
  MaskOutcome outcome;
  for (int image = 0; image < 8; ++image) {
    MaskPair pair = Drive::pair(image, image + 1);
    pair.wants_motion_depth = wants_motion_depth;
    pair.motion_uncertainty = {1e-3, 1e-3, 1e-3, 1e-5, 1e-5};
    pair.depth = 2.0 * pair.depth;
    pair.depth_std = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.5));
    CloudPoint mover;
    mover.position = {1.5F + 21.0F - static_cast<float>(image), 3.0F, 1.0F};  // left half of the image
    pair.dynamic_points = {mover};
    outcome = pipeline.process(pair);
    FlowField back = Drive::pair(image + 1, image).flow;
    back.fb_error = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1));
    pipeline.addBackward(kStep * (image + 1), kStep * image, back);
  }
  return outcome;
}

TEST(MaskPipeline, FollowsDepthWhereNothingSpeaksForAMover) {
  MaskPipelineParams params = Drive::params();
  params.motion_depth = true;
  params.use_depth_uncertainty = true;
  const MaskOutcome outcome = withDepthTwiceAsFar(params, false);
  EXPECT_NEAR(outcome.input.depth.at<float>(20, 130), 14.0F, 0.7F);
  EXPECT_LT(outcome.input.depth_std.at<float>(20, 130), 0.2F);
  EXPECT_NEAR(outcome.input.depth.at<float>(65, 26), 28.0F, 1e-3F) << "in the footprint of a dynamic return";
}

TEST(MaskPipeline, TellsTheDepthFromMotionThatMasksDoNotUse) {
  MaskPipelineParams params = Drive::params();
  params.use_depth_uncertainty = true;
  EXPECT_FALSE(withDepthTwiceAsFar(params, false).motion_depth);
  const MaskOutcome outcome = withDepthTwiceAsFar(params, true);
  ASSERT_TRUE(outcome.motion_depth);
  for (const cv::Point& pixel : {cv::Point(130, 20), cv::Point(26, 65)}) {
    EXPECT_NEAR(outcome.motion_depth->depth.at<float>(pixel), 14.0F, 0.7F);
    EXPECT_NEAR(outcome.input.depth.at<float>(pixel), 28.0F, 1e-3F);
  }
  EXPECT_LT(outcome.motion_depth->relative_std.at<float>(20, 130), 0.2F);
}

// Flow from the later image to the earlier leads to the previous mask by itself.
TEST(MaskPipeline, FlowThatRunsBackCarriesTheMemoryItself) {
  MaskPipelineParams params = Drive::params();
  params.memory = 10.0;
  MaskPipeline pipeline(params);
  pipeline.process(Drive::pair(1, 0, 10.0F));
  const MaskOutcome outcome = pipeline.process(Drive::pair(2, 1));
  ASSERT_FALSE(outcome.input.belief.empty());
  EXPECT_GT(cv::mean(outcome.input.belief(kPatch))[0], 0.0);
  EXPECT_LT(outcome.input.belief.at<float>(100, 20), 0.0F);
}

TEST(MaskPipeline, ThePastIsThatOfTheSameImageAndGrid) {
  MaskPipelineParams params = Drive::params();
  params.look_back = true;
  MaskPipeline pipeline(params);
  EXPECT_FALSE(pipeline.process(Drive::pair(0, 1)).looked_back) << "nothing was before";
  EXPECT_FALSE(pipeline.process(Drive::pair(1, 2)).looked_back) << "no flow back";
  pipeline.addBackward(2.0 * kStep, kStep, Drive::pair(2, 1).flow);
  EXPECT_FALSE(pipeline.process(Drive::pair(3, 4)).looked_back) << "an image is missing";
  pipeline.addBackward(4.0 * kStep, 3.0 * kStep, Drive::pair(4, 3).flow);
  EXPECT_TRUE(pipeline.process(Drive::pair(4, 5)).looked_back);
  FlowField coarse{cv::Mat(kHeight / 2, kWidth / 2, CV_32FC2, cv::Scalar::all(0.0)), {}};
  pipeline.addBackward(5.0 * kStep, 4.0 * kStep, coarse);
  EXPECT_FALSE(pipeline.process(Drive::pair(5, 6)).looked_back) << "on another grid";
  pipeline.addBackward(6.0 * kStep, 5.0 * kStep, Drive::pair(6, 5).flow);
  pipeline.clear();
  EXPECT_FALSE(pipeline.process(Drive::pair(6, 7)).looked_back);
}

// Images of messages are gone after the call.
TEST(MaskPipeline, WhatItKeepsIsItsOwn) {
  MaskPipelineParams params = Drive::params();
  params.look_back = true;
  MaskPipeline pipeline(params);
  MaskPair first = Drive::pair(0, 1);
  pipeline.process(first);
  FlowField back = Drive::pair(1, 0).flow;
  pipeline.addBackward(kStep, 0.0, back);
  for (cv::Mat* image : {&first.depth, &first.next_depth, &first.flow.flow, &back.flow})
    image->setTo(cv::Scalar::all(1e6));
  const MaskOutcome outcome = pipeline.process(Drive::pair(1, 2));
  EXPECT_TRUE(outcome.looked_back);
  EXPECT_EQ(cv::countNonZero(outcome.result.mask), 0);
}

// A bonnet does not move in the image, and fills its lower third. So much of it would spoil the motion as
// well.
TEST(MaskPipeline, TheVehicleInItsImageIsIgnored) {
  const cv::Rect bonnet(0, 80, kWidth, 40);
  const auto with_bonnet = [&bonnet](int first, int second) {
    MaskPair pair = Drive::pair(first, second, 10.0F);
    pair.flow.flow(bonnet).setTo(cv::Scalar::all(0.0));
    return pair;
  };
  const cv::Rect scene(0, 0, kWidth, bonnet.y);
  const std::string file = testing::TempDir() + "ignore_mask.png";
  cv::Mat image(4 * kHeight, 4 * kWidth, CV_8UC1, cv::Scalar(0));
  image(cv::Rect(0, 4 * bonnet.y, 4 * kWidth, 4 * bonnet.height)).setTo(255);
  ASSERT_TRUE(cv::imwrite(file, image));
  MaskPipelineParams params = Drive::params();
  params.look_back = params.refine = true;
  params.memory = 1.0;
  MaskPipeline marked(params);
  EXPECT_GT(cv::countNonZero(marked.process(with_bonnet(0, 1)).result.mask(bonnet)), 1000);
  params.ignore_mask = file;
  MaskPipeline pipeline;
  pipeline.configure(params);
  params.ignore_mask.clear();
  MaskPipeline without(params);
  for (int i = 0; i < 3; ++i) {
    if (i > 0) {
      pipeline.addBackward(kStep * i, kStep * (i - 1), with_bonnet(i, i - 1).flow);
      without.addBackward(kStep * i, kStep * (i - 1), Drive::pair(i, i - 1, 10.0F).flow);
    }
    const MaskOutcome outcome = pipeline.process(with_bonnet(i, i + 1));
    const MaskOutcome wanted = without.process(Drive::pair(i, i + 1, 10.0F));
    EXPECT_EQ(cv::countNonZero(outcome.result.mask(bonnet)), 0) << "pair " << i;
    EXPECT_EQ(cv::countNonZero(outcome.result.valid(bonnet)), 0);
    EXPECT_EQ(cv::countNonZero(outcome.result.mask(kPatch)), kPatch.area());
    EXPECT_EQ(cv::countNonZero(outcome.result.mask(scene) != wanted.result.mask(scene)), 0);
    EXPECT_NEAR((outcome.input.T_current_from_previous.translation() - Eigen::Vector3d(0, 0, -1)).norm(), 0.0,
                1e-3);
  }
  ASSERT_TRUE(cv::imwrite(file, image.colRange(0, 2 * kWidth)));
  pipeline.configure(params);
  params.ignore_mask = file;
  pipeline.configure(params);
  test::expectRefusal([&] { pipeline.process(with_bonnet(3, 4)); }, {file, "320 x 480", "160 x 120"});
  params.ignore_mask = "/nowhere.png";
  test::expectRefusal<InvalidParameter>([&] { pipeline.configure(params); }, {"ignore_mask", "/nowhere.png"});
}

TEST(MaskPipeline, OnlyWhatChangesScoresEndsTheHistory) {
  using Change = std::function<void(MaskPipelineParams&)>;
  const auto looks_back_after = [](const Change& change) {
    MaskPipelineParams params = Drive::params();
    params.look_back = true;
    MaskPipeline pipeline(params);
    change(params);
    return secondOf(pipeline, 10.0F, [&] { pipeline.configure(params); }).looked_back;
  };
  const std::vector<Change> scores = {
      [](MaskPipelineParams& p) { p.motion.paper.k = 8.0; },
      [](MaskPipelineParams& p) { p.motion.uncertainty.noise.flow_std = 1.0; },
      [](MaskPipelineParams& p) { p.motion.radar.static_gain = 1.0; },
      [](MaskPipelineParams& p) { p.motion_uncertainty.tilt_std = 0.03; },
      [](MaskPipelineParams& p) { p.use_depth_uncertainty = true; },
      [](MaskPipelineParams& p) { p.refine = true; },
      [](MaskPipelineParams& p) { p.refine_ground = true; },
      [](MaskPipelineParams& p) { p.ground.uncertainty.pitch_std = 0.01; },
      [](MaskPipelineParams& p) { p.refinement.stride = 8; },
  };
  for (std::size_t i = 0; i < scores.size(); ++i) EXPECT_FALSE(looks_back_after(scores[i])) << i;
  const std::vector<Change> others = {
      [](MaskPipelineParams&) {},
      [](MaskPipelineParams& p) { p.memory = 0.4; },
      [](MaskPipelineParams& p) { p.radar_min_residual = 1.0; },
  };
  for (std::size_t i = 0; i < others.size(); ++i) EXPECT_TRUE(looks_back_after(others[i])) << i;
}

TEST(MaskPipeline, OnlyReturnsWithAMotionOfTheirOwnAreEvidence) {
  MaskPipelineParams params = Drive::params();
  params.motion.radar.dynamic_gain = params.motion.radar.static_gain = 1.0;
  params.radar_min_residual = 0.5;
  MaskPair pair = Drive::pair(0, 1);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  for (const float residual : {0.4F, -0.4F, 0.6F, -0.6F, kUnknown})
    pair.dynamic_points.push_back({{20.0F, 1.0F, 0.5F}, residual});
  pair.static_points.push_back({{10.0F, 0.0F, 0.5F}, 0.0F});
  const MotionInput input = MaskPipeline(params).process(pair).input;
  ASSERT_EQ(input.dynamic_points.size(), 3U);
  EXPECT_TRUE(
      input.dynamic_points[0].position.isApprox(Eigen::Vector3f(-1.0F, 1.1F, 18.5F)));  // in the camera frame
  EXPECT_EQ(input.static_points.size(), 1U);
  params.motion.radar.dynamic_gain = params.motion.radar.static_gain = 0.0;
  const MotionInput without = MaskPipeline(params).process(pair).input;
  EXPECT_TRUE(without.dynamic_points.empty() && without.static_points.empty());
}

TEST(MaskPipeline, TheForwardBackwardErrorIsNoiseOrAReasonToExclude) {
  MaskPipelineParams params = Drive::params();
  MaskPair pair = Drive::pair(0, 1);
  pair.flow.valid = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  pair.flow.fb_error = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.5));
  const MotionInput by_uncertainty = MaskPipeline(params).process(pair).input;
  EXPECT_TRUE(by_uncertainty.flow_valid.empty());
  EXPECT_FALSE(by_uncertainty.fb_error.empty());
  EXPECT_GT(by_uncertainty.motion_covariance.trace(), 0.0);
  params.motion.score = MotionScore::kPaper;
  const MotionInput paper = MaskPipeline(params).process(pair).input;
  EXPECT_FALSE(paper.flow_valid.empty());
  EXPECT_TRUE(paper.fb_error.empty());
  EXPECT_EQ(paper.motion_covariance.trace(), 0.0);
}

}  // namespace
}  // namespace radar_dot
