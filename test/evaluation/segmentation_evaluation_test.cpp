// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/segmentation_evaluation.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "fixtures/tool_run.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;

/// A short simulated drive with all its ground truth, made once.
class SegmentationEvaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / "radar_dot_segmentation_evaluation";
    fs::remove_all(folder_);
    const test::Outcome outcome =
        test::runCommand(std::string(SIMULATOR) + " --output " + folder_.string() +
                         " --scenarios oncoming,car_park --duration 2 --frames pairs --width 640 --height 360"
                         " --lidar-rate 2");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    dataset::LoadOptions load;
    load.version = "v1.0-sim";
    tables_ = std::make_unique<dataset::Tables>(dataset::Tables::load(folder_, load));
    masks_ = dataset::readInstanceMasks(*tables_);
  }
  static void TearDownTestSuite() {
    tables_.reset();
    fs::remove_all(folder_);
  }

  static SegmentationReport evaluate(const SegmentationEvaluationOptions& options, dataset::Index scene = 0) {
    std::vector<const dataset::InstanceMask*> masks;
    for (const dataset::InstanceMask& mask : masks_) masks.push_back(&mask);
    return evaluateSegmentation(*tables_, scene, masks, options);
  }
  static SegmentationEvaluationOptions everythingTrue() {
    SegmentationEvaluationOptions options;
    options.flow = "ground_truth";
    options.depth = "ground_truth";
    options.velocity = "ground_truth";
    options.working_width = 0;
    options.min_true_residual = 1.0;
    // Everything is exact: what differs at all moves. Depth alone is not looked at: between the pixels of an
    // edge it means nothing.
    options.motion.min_threshold = 0.05;
    options.motion.k = 6.0;
    options.motion.lambda = 0.0;
    options.motion.occlusion_margin = 1.0;
    options.motion.predicted_in_view = false;
    options.motion.opening = 0;
    options.motion.closing = 0;
    return options;
  }

  static fs::path folder_;
  static std::unique_ptr<dataset::Tables> tables_;
  static std::vector<dataset::InstanceMask> masks_;
};
fs::path SegmentationEvaluation::folder_;
std::unique_ptr<dataset::Tables> SegmentationEvaluation::tables_;
std::vector<dataset::InstanceMask> SegmentationEvaluation::masks_;

TEST_F(SegmentationEvaluation, TrueInputsGiveTheTrueMask) {
  for (const char* pairs : {"keyframes", "next"}) {
    SCOPED_TRACE(pairs);
    SegmentationEvaluationOptions options = everythingTrue();
    options.pairs = pairs;
    const SegmentationReport report = evaluate(options);
    EXPECT_EQ(report.scene, tables_->scenes[0].name);
    EXPECT_GT(report.pixels.true_positives, 500U);
    EXPECT_GE(report.iou(), 0.9) << report.pixels.true_positives << " " << report.pixels.false_positives
                                 << " " << report.pixels.false_negatives;
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
  options.depth = "noisy";
  options.pairs = "next";
  options.working_width = 320;
  const SegmentationReport report = evaluate(options);
  EXPECT_EQ(report.without_motion, 0U);
  EXPECT_GT(report.iou(), 0.05);
}

TEST_F(SegmentationEvaluation, WrongMotionFillsThePicture) {
  SegmentationEvaluationOptions options = everythingTrue();
  options.min_true_residual = 0.0;
  // Radar as if the car drove backwards: nothing agrees, so that the score of the static world is large.
  options.velocity = "radar";
  const double right = evaluate(options).iou();
  options.extraction.doppler_scale = -1.0;
  const double wrong = evaluate(options).iou();
  EXPECT_LT(wrong, 0.5 * right);
}

TEST_F(SegmentationEvaluation, RefusesWhatItDoesNotKnow) {
  SegmentationEvaluationOptions options;
  options.pairs = "triplets";
  EXPECT_THROW(evaluate(options), std::invalid_argument);
  options = {};
  options.flow = "files";
  EXPECT_THROW(evaluate(options), std::invalid_argument);
  options.flow_directory = "/nowhere";
  EXPECT_THROW(evaluate(options), dataset::DatasetError);
  options = {};
  options.channel = "CAM_BACK";
  EXPECT_THROW(evaluate(options), dataset::DatasetError);
}

}  // namespace
}  // namespace radar_dot::evaluation
