// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_evaluation.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "evaluation/simulated_dataroot.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;

class DepthEvaluation : public ::testing::Test {
 protected:
  // A copy: tests hide parts of it.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    fs::copy(SIMULATED_DATAROOT, folder_->path(), fs::copy_options::recursive);
    dataroot_ = std::make_unique<test::SimulatedDataroot>(folder_->path());
  }
  static DepthReport evaluate(const std::string& depth, DepthTruth truth) {
    DepthEvaluationOptions options;
    options.depth.depth.backend = depth;
    options.truth = truth;
    return evaluateDepth(dataroot_->tables(), 0, options);
  }
  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline std::unique_ptr<test::SimulatedDataroot> dataroot_;
};

TEST_F(DepthEvaluation, TheTruthHasNoErrors) {
  const DepthReport report = evaluate("ground_truth", DepthTruth::kGroundTruth);
  EXPECT_EQ(report.scene, dataroot_->tables().scenes[0].name);
  EXPECT_GE(report.images, 4U);
  EXPECT_EQ(report.without_truth, 0U);
  for (const DepthErrors::Sums& sums : report.errors.within) {
    EXPECT_GT(sums.compared, 10000U);
    EXPECT_EQ(sums.absolute, 0.0);
    EXPECT_EQ(sums.coverage(), 1.0);
  }
}

TEST_F(DepthEvaluation, BackendsDiffer) {
  const DepthErrors::Sums noisy = evaluate("noisy", DepthTruth::kGroundTruth).errors.within[0];
  const DepthErrors::Sums radar = evaluate("radar_ground", DepthTruth::kGroundTruth).errors.within[0];
  EXPECT_NEAR(noisy.meanAbsoluteError(), 1.35, 0.2);
  EXPECT_NEAR(radar.meanAbsoluteError(), 4.6, 0.7);
}

// Keyframes and the image after each: half a second lies before a keyframe, and nothing is followed.
TEST_F(DepthEvaluation, MotionAtALowRateIsItsPrior) {
  const DepthReport motion = evaluate("motion", DepthTruth::kGroundTruth);
  const DepthReport prior = evaluate("radar_ground", DepthTruth::kGroundTruth);
  EXPECT_EQ(motion.images, prior.images);
  EXPECT_NEAR(motion.errors.within[2].meanAbsoluteError(), prior.errors.within[2].meanAbsoluteError(), 1e-4);
  EXPECT_EQ(motion.errors.within[2].coverage(), 1.0);
}

TEST_F(DepthEvaluation, StaticPixelsAfterATime) {
  DepthEvaluationOptions options;
  options.depth.depth.backend = "ground_truth";
  const DepthReport all = evaluateDepth(dataroot_->tables(), 0, options);
  options.static_only = true;
  const DepthReport still = evaluateDepth(dataroot_->tables(), 0, options);
  EXPECT_EQ(still.images, all.images);
  EXPECT_LT(still.errors.within[0].true_pixels, all.errors.within[0].true_pixels);  // oncoming cars
  options.after = 1.0;
  EXPECT_EQ(evaluateDepth(dataroot_->tables(), 0, options).images, all.images - 2);
}

// No scan is as near to its image as a millisecond: what stands on the ground is not known any more.
TEST_F(DepthEvaluation, RadarCountsWithinItsAge) {
  DepthEvaluationOptions options;
  options.depth.depth.backend = "radar_ground";
  const auto error = [&] {
    return evaluateDepth(dataroot_->tables(), 0, options).errors.within[0].meanAbsoluteError();
  };
  const double with_radar = error();
  options.depth.radar_max_age = 0.001;
  EXPECT_GT(error(), 1.2 * with_radar);  // 1.4
}

// Every backend knows about how wrong it is: within a factor of one and a half on this one street.
TEST_F(DepthEvaluation, TheDeclaredSigmasAreOfTheSizeOfTheErrors) {
  for (const char* depth : {"noisy", "radar_ground", "lidar"}) {
    const NormalisedErrors errors = evaluate(depth, DepthTruth::kGroundTruth).errors.normalised;
    EXPECT_GT(errors.count(), 10000U) << depth;
    EXPECT_GT(errors.quantile(0.6827), 0.65) << depth;  // 0.94, 0.72, 1.18
    EXPECT_LT(errors.quantile(0.6827), 1.5) << depth;
  }
}

// Lidar and depth image tell of one world: the truths agree but at edges.
TEST_F(DepthEvaluation, LidarIsWhereTheTrueDepthIs) {
  const DepthReport report = evaluate("ground_truth", DepthTruth::kLidar);
  EXPECT_EQ(report.without_truth, 0U);
  EXPECT_GT(report.errors.within[0].compared, 1000U);
  EXPECT_LT(report.errors.within[0].meanAbsoluteError(), 0.9);  // 0.74, all at edges
}

TEST_F(DepthEvaluation, CompletedLidarIsNearTheHeldOutPoints) {
  const DepthErrors::Sums sums = evaluate("lidar", DepthTruth::kLidar).errors.within[0];
  EXPECT_GT(sums.coverage(), 0.9);  // 0.94
  EXPECT_NEAR(sums.meanAbsoluteError(), 0.54, 0.1);
}

/// Moves one half of the points of a sweep to the sensor, where no camera sees them: of each beam every
/// second one, that half beginning with the first one in even beams (0) or in odd beams (1).
void hideHalf(const fs::path& sweep, std::size_t half) {
  constexpr std::size_t kValues = 5;  // x, y, z, intensity, ring
  std::string bytes = test::readFile(sweep);
  std::map<float, std::size_t> counts;
  for (std::size_t start = 0; start < bytes.size(); start += kValues * sizeof(float)) {
    std::array<float, kValues> record{};
    std::memcpy(record.data(), bytes.data() + start, sizeof(record));
    const auto beam = static_cast<std::size_t>(record[4]);
    if ((beam + counts[record[4]]++) % 2 != half) continue;
    record[0] = record[1] = record[2] = 0.0F;
    std::memcpy(bytes.data() + start, record.data(), sizeof(record));
  }
  test::writeFile(sweep, bytes);
}

// Without the one half the backend has nothing to see, without the other there is nothing to compare with.
TEST_F(DepthEvaluation, HeldOutPointsAreNotSeen) {
  const dataset::Tables& tables = dataroot_->tables();
  const dataset::Index first = tables.readingsOf(0, "LIDAR_TOP").front();
  const fs::path sweep = tables.path(tables.sample_data[static_cast<std::size_t>(first)]);
  const std::string original = test::readFile(sweep);
  const auto evaluate_first = [&tables] {
    DepthEvaluationOptions options;
    options.depth.depth.backend = "lidar";
    options.truth = DepthTruth::kLidar;
    options.max_images = 1;
    return evaluateDepth(tables, 0, options).errors.within[0];
  };
  hideHalf(sweep, 0);
  const DepthErrors::Sums nothing_seen = evaluate_first();
  test::writeFile(sweep, original);
  hideHalf(sweep, 1);
  const DepthErrors::Sums nothing_held_out = evaluate_first();
  test::writeFile(sweep, original);
  EXPECT_GT(nothing_seen.true_pixels, 500U);
  EXPECT_EQ(nothing_seen.compared, 0U);
  EXPECT_EQ(nothing_held_out.true_pixels, 0U);
}

TEST_F(DepthEvaluation, ImagesWithoutASweepAreCountedNotCompared) {
  const dataset::Tables& tables = dataroot_->tables();
  const std::size_t images = evaluate("ground_truth", DepthTruth::kLidar).images;
  const dataset::Index first = tables.readingsOf(0, "LIDAR_TOP").front();
  const fs::path sweep = tables.path(tables.sample_data[static_cast<std::size_t>(first)]);
  const fs::path hidden = sweep.string() + ".hidden";
  fs::rename(sweep, hidden);
  const DepthReport report = evaluate("ground_truth", DepthTruth::kLidar);
  const auto depth_by_lidar = [] { evaluate("lidar", DepthTruth::kGroundTruth); };
  test::expectRefusal<dataset::DatasetError>(depth_by_lidar, {"no LIDAR_TOP sweep", "CAM_FRONT"});
  fs::rename(hidden, sweep);
  EXPECT_EQ(report.images, images - 1);
  EXPECT_EQ(report.without_truth, 1U);
}

TEST_F(DepthEvaluation, TheTruthIsWhatTheDatarootHas) {
  const fs::path truth = folder_->path() / "ground_truth" / "depth";
  const fs::path hidden = truth.string() + ".hidden";
  EXPECT_EQ(truthOf({}, folder_->path()), DepthTruth::kGroundTruth);
  fs::rename(truth, hidden);
  EXPECT_EQ(truthOf({}, folder_->path()), DepthTruth::kLidar);
  EXPECT_GE(evaluate("lidar", DepthTruth::kAuto).images, 4U);
  test::expectRefusal<dataset::DatasetError>([] { evaluate("lidar", DepthTruth::kGroundTruth); },
                                             {truth.string(), "truth lidar"});
  fs::rename(hidden, truth);
}

TEST_F(DepthEvaluation, TheFirstImagesOnly) {
  DepthEvaluationOptions options;
  options.depth.depth.backend = "ground_truth";
  options.max_images = 2;
  EXPECT_EQ(evaluateDepth(dataroot_->tables(), 0, options).images, 2U);
}

TEST_F(DepthEvaluation, RefusesWhatItDoesNotKnow) {
  const auto expect = [](const DepthEvaluationOptions& options, const std::vector<std::string>& parts) {
    test::expectRefusal<std::exception>([&options] { evaluateDepth(dataroot_->tables(), 0, options); },
                                        parts);
  };
  DepthEvaluationOptions options;
  options.depth.depth.backend = "stereo";
  expect(options, {"stereo"});
  options = {};
  options.depth.depth.backend = "files";
  expect(options, {"files", "depth_directory"});
  options.depth_input.depth_directory = "/nowhere";
  expect(options, {"/nowhere"});
  options = {};
  options.camera = "CAM_ROOF";
  expect(options, {"CAM_ROOF"});
}

TEST(DepthReports, FiguresStandInTableAndFiles) {
  DepthReport report;
  report.scene = "scene-0001";
  report.images = 2;
  report.without_truth = 1;
  report.errors.within[0] = {200, 100, 150.0, 400.0};
  report.errors.normalised.add(1.25);
  DepthReport overall = report;
  overall += report;
  EXPECT_EQ(
      formatCsv({report}, overall),
      "scene,mae_50,rmse_50,coverage_50,mae_70,rmse_70,coverage_70,mae_80,rmse_80,coverage_80,sigma_median,"
      "sigma_68,images,without_truth,true_pixels_50,compared_50,true_pixels_70,compared_70,true_pixels_80,"
      "compared_80\n"
      "scene-0001,1.500000,2.000000,0.500000,,,,,,,1.251699,1.251699,2,1,200,100,0,0,0,0\n"
      "overall,1.500000,2.000000,0.500000,,,,,,,1.251699,1.251699,4,2,400,200,0,0,0,0\n");
  EXPECT_NE(formatTable({report}, overall).find("Overall             4         2     1.500     2.000"),
            std::string::npos)
      << formatTable({report}, overall);
}

TEST(RealDepth, CompletedLidarIsNearTheHeldOutPoints) {
  const std::string dataroot = std::string(RADAR_DOT_SHARED_DATA) + "/nuscenes_mini_real";
  if (!fs::exists(dataroot)) GTEST_SKIP() << dataroot << " is not there";
  dataset::LoadOptions load;
  load.scenes = {"scene-0061"};
  const dataset::Tables tables = dataset::Tables::load(dataroot, load);
  DepthEvaluationOptions options;
  options.depth.depth.backend = "lidar";
  options.truth = DepthTruth::kLidar;
  const DepthReport report = evaluateDepth(tables, tables.findScene("scene-0061"), options);
  EXPECT_EQ(report.images, 1U);
  EXPECT_GT(report.errors.within[0].coverage(), 0.94);          // 0.97
  EXPECT_LT(report.errors.within[0].meanAbsoluteError(), 0.8);  // 0.63
}

}  // namespace
}  // namespace radar_dot::evaluation
