// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/segmentation_evaluation.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation/segmentation_results.h"
#include "evaluation/simulated_dataroot.h"
#include "fixtures/refusal.h"
#include "radar_dot/common/stamps.h"

namespace radar_dot::evaluation {
namespace {

class SegmentationEvaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { dataroot_ = std::make_unique<test::SimulatedDataroot>(); }

  static SegmentationReport evaluate(const SegmentationEvaluationOptions& options, dataset::Index scene = 0) {
    return evaluateSegmentation(dataroot_->tables(), scene, dataroot_->masks(), options);
  }
  static SegmentationEvaluationOptions everythingTrue() {
    SegmentationEvaluationOptions options;
    options.optical_flow.flow.backend = "ground_truth";
    options.depth.depth.backend = "ground_truth";
    options.velocity = VelocitySource::kGroundTruth;
    options.optical_flow.flow.working_width = options.depth.working_width = 0;
    options.min_true_residual = 1.0;
    // Everything is exact: what differs at all moves. Depth alone is not looked at: between the pixels of an
    // edge it means nothing.
    options.segmentation.motion.paper.min_threshold = 0.05;
    options.segmentation.motion.paper.k = 6.0;
    options.segmentation.motion.paper.lambda = 0.0;
    options.segmentation.motion.occlusion_margin = 1.0;
    options.segmentation.motion.predicted_in_view = false;
    options.segmentation.motion.cleanup.opening = 0;
    options.segmentation.motion.cleanup.closing = 0;
    return options;
  }

  /// True masks, and the paper's estimator without consensus or filter: many movers spoil it, unless it is
  /// told which.
  static SegmentationEvaluationOptions plainVelocity() {
    SegmentationEvaluationOptions options = everythingTrue();
    options.velocity = VelocitySource::kRadar;
    options.ego_velocity.estimator.solver = Solver::kLeastSquares;
    options.ego_velocity.estimator.model = MotionModel::kPlanar;
    options.ego_velocity.filter = false;
    return options;
  }

  /// m/s, of the first scene, from its first and last pose.
  static double meanSpeed() {
    const dataset::Tables& tables = dataroot_->tables();
    const std::vector<dataset::Index> poses = tables.egoPosesOf(0);
    const dataset::EgoPose& first = tables.ego_poses[static_cast<std::size_t>(poses.front())];
    const dataset::EgoPose& last = tables.ego_poses[static_cast<std::size_t>(poses.back())];
    const Eigen::Vector3d way = last.T_map_from_base().translation() - first.T_map_from_base().translation();
    return way.norm() / (1e-6 * static_cast<double>(last.timestamp_us - first.timestamp_us));
  }

  static inline std::unique_ptr<test::SimulatedDataroot> dataroot_;
};

TEST_F(SegmentationEvaluation, TrueInputsGiveTheTrueMask) {
  for (const ImagePairs pairs : {ImagePairs::kKeyframes, ImagePairs::kNext}) {
    SCOPED_TRACE(std::string(toString(pairs)));
    SegmentationEvaluationOptions options = everythingTrue();
    options.pairs.pairs = pairs;
    const SegmentationReport report = evaluate(options);
    EXPECT_EQ(report.scene, dataroot_->tables().scenes[0].name);
    EXPECT_GT(report.pixels.true_positives, 500U);
    EXPECT_GE(report.iou(), 0.9) << report.pixels.true_positives << " " << report.pixels.false_positives
                                 << " " << report.pixels.false_negatives;
  }
}

TEST_F(SegmentationEvaluation, PeopleCountApart) {
  for (const char* category : {"human.pedestrian.adult", "vehicle.car"}) {
    SCOPED_TRACE(category);
    std::vector<dataset::InstanceMask> instances;
    for (const dataset::InstanceMask* mask : dataroot_->masks()) instances.push_back(*mask);
    std::vector<const dataset::InstanceMask*> masks;
    for (dataset::InstanceMask& instance : instances) {
      instance.category_name = category;
      masks.push_back(&instance);
    }
    const SegmentationReport report = evaluateSegmentation(dataroot_->tables(), 0, masks, everythingTrue());
    const bool are_people = std::string(category) != "vehicle.car";
    const Confusion& pixels = report.pixels;
    EXPECT_EQ(report.people_found, are_people ? pixels.true_positives : 0U);
    EXPECT_EQ(report.people_pixels, are_people ? pixels.true_positives + pixels.false_negatives : 0U);
  }
}

TEST_F(SegmentationEvaluation, NothingMovesInTheCarPark) {
  SegmentationEvaluationOptions options = everythingTrue();
  options.min_true_residual = 0.0;
  const SegmentationReport report = evaluate(options, 1);
  EXPECT_EQ(report.pixels.true_positives + report.pixels.false_negatives, 0U);
  EXPECT_LE(report.falsePositiveShare(), 0.001);
}

TEST_F(SegmentationEvaluation, RadarDisAndNoisyDepthFindMovers) {
  SegmentationEvaluationOptions options;
  options.depth.depth.backend = "noisy";
  options.pairs.pairs = ImagePairs::kNext;
  options.optical_flow.flow.working_width = options.depth.working_width = 320;
  const SegmentationReport report = evaluate(options);
  EXPECT_EQ(report.without_motion, 0U);
  EXPECT_GT(report.iou(), 0.33);  // 0.40
}

// Keyframes are half a second apart: half of what moves leaves the view until the next, or is lost by the
// flow.
TEST_F(SegmentationEvaluation, LookingBackFindsMoreMovers) {
  SegmentationEvaluationOptions options;
  options.depth.depth.backend = "noisy";
  options.optical_flow.flow.working_width = options.depth.working_width = 400;
  options.optical_flow.flow.forward_backward = true;
  options.optical_flow.flow.initialisation = FlowStart::kExpected;
  options.segmentation.motion.score = MotionScore::kUncertainty;
  options.segmentation.refine = true;
  const SegmentationReport plain = evaluate(options);
  options.segmentation.look_back = true;
  const SegmentationReport back = evaluate(options);
  EXPECT_GT(back.iou(), 0.28);  // and 0.137 without
  EXPECT_GT(back.iou(), 2.0 * plain.iou());
  EXPECT_GT(back.pixels.true_positives, plain.pixels.true_positives);
  // Of the first image of a scene there is no past, and with it alone nothing changes.
  options.pairs.max_pairs = 1;
  const std::size_t first = evaluate(options).pixels.true_positives;
  options.segmentation.look_back = false;
  EXPECT_EQ(evaluate(options).pixels.true_positives, first);
  options.pairs.max_pairs = 0;
  options.segmentation.memory = 0.4;
  // What memory gains, it gains at the rate of the camera; half a second apart it may go either way, by how
  // the processor draws the scene: 0.152 instead of 0.137, and 0.126 instead of 0.127.
  const SegmentationReport remembered = evaluate(options);
  EXPECT_GT(remembered.pixels.true_positives, plain.pixels.true_positives);
  EXPECT_GT(remembered.iou(), 0.97 * plain.iou());
  // With pairs of neighbouring images the one before a pair is no part of another.
  options = {};
  options.depth.depth.backend = "noisy";
  options.pairs.pairs = ImagePairs::kNext;
  options.optical_flow.flow.working_width = options.depth.working_width = 320;
  options.optical_flow.flow.forward_backward = true;
  options.segmentation.motion.score = MotionScore::kUncertainty;
  const SegmentationReport once = evaluate(options);
  EXPECT_GT(once.iou(), 0.17);  // 0.21
  options.segmentation.look_back = true;
  const SegmentationReport twice = evaluate(options);
  EXPECT_NE(twice.pixels.true_positives, once.pixels.true_positives);
  EXPECT_GT(twice.iou(), 0.15);  // 0.18: without refinement the past is of no use over so short a time
}

TEST_F(SegmentationEvaluation, ThePastNeedsAFlowBackAndTheScoreByUncertainty) {
  SegmentationEvaluationOptions options;
  options.segmentation.look_back = true;
  options.segmentation.motion.score = MotionScore::kUncertainty;
  test::expectRefusal([&] { evaluate(options); }, {"forward_backward"});
  options.optical_flow.flow.backend = "ground_truth";
  test::expectRefusal([&] { evaluate(options); }, {"ground_truth"});
  options.segmentation.look_back = false;
  options.segmentation.memory = -1.0;
  test::expectRefusal([&] { evaluate(options); }, {"memory", "-1"});
}

TEST_F(SegmentationEvaluation, TheBestMasksAreEmptyWhereNothingMoves) {
  SegmentationEvaluationOptions options;
  options.depth.depth.backend = "noisy";
  options.optical_flow.flow.initialisation = FlowStart::kExpected;
  options = bestOptions(options);
  const SegmentationReport report = evaluate(options, 1);
  EXPECT_GT(report.frames, 0U);
  EXPECT_LE(report.falsePositiveShare(), 0.0005);  // 0
}

TEST_F(SegmentationEvaluation, WrongMotionFillsThePicture) {
  SegmentationEvaluationOptions options = everythingTrue();
  options.min_true_residual = 0.0;
  // Radar as if the car drove backwards: nothing agrees, so that the score of the static world is large.
  options.velocity = VelocitySource::kRadar;
  const double right = evaluate(options).iou();
  options.ego_velocity.extraction.doppler_scale = -1.0;
  const double wrong = evaluate(options).iou();
  EXPECT_GT(right, 0.3);           // 0.39
  EXPECT_LT(wrong, 0.05 * right);  // 0.02
}

// A true depth declares 0.01: with its own word, the constant does not matter.
TEST_F(SegmentationEvaluation, UsesTheUncertaintyThatTheDepthDeclares) {
  SegmentationEvaluationOptions options = everythingTrue();
  options.segmentation.motion.score = MotionScore::kUncertainty;
  options.segmentation.motion.uncertainty.noise.depth_std = 0.01;
  const Confusion expected = evaluate(options).pixels;
  options.segmentation.motion.uncertainty.noise.depth_std = 5.0;
  const Confusion constant = evaluate(options).pixels;
  options.segmentation.use_depth_uncertainty = true;
  const Confusion declared = evaluate(options).pixels;
  EXPECT_GT(expected.true_positives, 0U);
  EXPECT_LT(constant.true_positives, expected.true_positives / 5);  // a tenth
  EXPECT_EQ(declared.true_positives, expected.true_positives);
  EXPECT_EQ(declared.false_positives, expected.false_positives);
}

TEST_F(SegmentationEvaluation, TheErrorOfTheVelocityIsReported) {
  SegmentationEvaluationOptions options = everythingTrue();
  EXPECT_EQ(evaluate(options).velocity_error.count, 0U);  // the true one has none
  for (const VelocitySource velocity : {VelocitySource::kRadar, VelocitySource::kRadarStart}) {
    SCOPED_TRACE(std::string(toString(velocity)));
    options.velocity = velocity;
    options.ego_velocity.extraction.doppler_scale = 1.0;
    const SegmentationReport right = evaluate(options);
    EXPECT_EQ(right.velocity_error.count, right.frames);
    EXPECT_LT(right.velocity_error.value(), 0.3);
    // A Doppler that reads a half too high makes the vehicle half as fast again.
    options.ego_velocity.extraction.doppler_scale = 1.5;
    EXPECT_NEAR(evaluate(options).velocity_error.value(), 0.5 * meanSpeed(), 0.3 + 0.05 * meanSpeed());
  }
}

// The first pair has no mask before it, and a mask of no age is none at the next pair. Which returns a mask
// marks is tested where it is done; that the velocity of so few pairs becomes better is up to the noise.
TEST_F(SegmentationEvaluation, MasksSpeakOnlyAfterTheirPairAndWithinTheirAge) {
  for (const VelocitySource velocity : {VelocitySource::kRadar, VelocitySource::kRadarStart}) {
    SCOPED_TRACE(std::string(toString(velocity)));
    SegmentationEvaluationOptions options = plainVelocity();
    options.velocity = velocity;
    const SegmentationReport without = evaluate(options);
    options.mask_to_velocity = true;
    const SegmentationReport with = evaluate(options);
    EXPECT_EQ(with.velocity_error.count, without.velocity_error.count);
    EXPECT_NE(with.velocity_error.sum, without.velocity_error.sum);
    options.ego_velocity.mask_max_age = 0.3;
    EXPECT_EQ(evaluate(options).velocity_error.sum, without.velocity_error.sum);
    options = plainVelocity();
    options.velocity = velocity;
    options.pairs.max_pairs = 1;
    const double first = evaluate(options).velocity_error.sum;
    options.mask_to_velocity = true;
    EXPECT_EQ(evaluate(options).velocity_error.sum, first);
  }
}

TEST_F(SegmentationEvaluation, TheLoopNeedsAVelocityByRadarAndAnAge) {
  SegmentationEvaluationOptions options = everythingTrue();
  options.mask_to_velocity = true;
  test::expectRefusal([&options] { evaluate(options); }, {"mask_to_velocity", "ground_truth"});
  options.velocity = VelocitySource::kRadar;
  options.ego_velocity.mask_max_age = -1.0;
  test::expectRefusal([&options] { evaluate(options); }, {"mask_max_age", "-1"});
}

TEST_F(SegmentationEvaluation, RefusesWhatItDoesNotKnow) {
  SegmentationEvaluationOptions options;
  options.optical_flow.flow.backend = "files";
  EXPECT_THROW(evaluate(options), std::invalid_argument);
  options.pairs.flow_directory = "/nowhere";
  EXPECT_THROW(evaluate(options), dataset::DatasetError);
  options = {};
  options.pairs.camera = "CAM_BACK";
  EXPECT_THROW(evaluate(options), dataset::DatasetError) << "so that a scene without it is left out";
}

}  // namespace
}  // namespace radar_dot::evaluation
