// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"
#include "radar_dot/evaluation/object_evaluation.h"

namespace radar_dot::evaluation {
namespace {

using test::NuscenesFixture;

/// The fixture with masks and depths of the car ahead: 15 m ahead at the first keyframe, 2 m/s faster.
class ObjectMasksTest : public ::testing::Test {
 protected:
  ObjectMasksTest() : fixture_(withKeyframes(8)), tables_(dataset::Tables::load(fixture_.dataroot())) {
    const test::FixtureScene& scene = fixture_.scene(NuscenesFixture::kStraightScene);
    std::filesystem::create_directory(masks());
    std::filesystem::create_directory(depths());
    for (const dataset::Index row :
         tables_.readingsOf(tables_.findScene(NuscenesFixture::kStraightScene), "CAM_FRONT")) {
      const dataset::SampleData& image = tables_.sample_data[static_cast<std::size_t>(row)];
      const std::string name = tables_.path(image).stem().string() + ".png";
      const int* box = NuscenesFixture::kMovingPixels;
      cv::Mat mask = cv::Mat::zeros(90, 160, CV_8UC1);
      mask(cv::Rect(box[0] / 10, box[1] / 10, box[2] / 10, box[3] / 10)) = 255;
      cv::imwrite((masks() / name).string(), mask);
      const double camera_ahead = 1.7;  // m, of the base frame's origin
      const double depth = 15.0 + 2.0 * scene.drive.seconds(image.timestamp_us) - camera_ahead;
      cv::imwrite((depths() / name).string(), cv::Mat(90, 160, CV_16UC1, cv::Scalar(256.0 * depth)));
    }
  }

  static test::FixtureOptions withKeyframes(int count) {
    test::FixtureOptions options;
    options.samples_per_scene = count;
    return options;
  }
  std::filesystem::path masks() const { return folder_.path() / "masks"; }
  std::filesystem::path depths() const { return folder_.path() / "depths"; }

  /// Tracks that live and are confirmed at the 2 Hz of the masks; depth is exact.
  ObjectEvaluationOptions options() const {
    ObjectEvaluationOptions options;
    options.masks.directory = masks().string();
    options.depth.depth.backend = "files";
    options.depth_input.depth_directory = depths().string();
    options.objects.regions.relative_depth_std = 0.02;
    options.objects.tracker.initial_speed_std = 10.0;
    options.objects.tracker.min_coast = options.objects.tracker.max_coast = 0.6;
    options.objects.tracker.confirm_hits = 2;
    return options;
  }

  /// No return of the radar says that anything moves.
  static void blindRadar(ObjectEvaluationOptions& options) {
    options.objects.returns.segmentation.isolated_threshold =
        options.objects.returns.segmentation.supported_threshold = 100.0;
    options.objects.detection.weak_threshold = std::numeric_limits<double>::infinity();
    options.doubtful = false;
  }

  ObjectReport evaluate(const ObjectEvaluationOptions& options) const {
    return evaluateObjects(tables_, tables_.findScene(NuscenesFixture::kStraightScene), options);
  }

  const test::TemporaryFolder folder_;
  const NuscenesFixture fixture_;
  const dataset::Tables tables_;
};

TEST_F(ObjectMasksTest, AMoverSeenByTheMaskAloneIsFoundWhereMasksStartTracks) {
  ObjectEvaluationOptions options = this->options();
  blindRadar(options);
  EXPECT_EQ(evaluate(options).all().matched, 0U) << "masks only carry tracks on";
  options.objects.mask_starts_tracks = true;
  const ObjectReport report = evaluate(options);
  EXPECT_EQ(report.all().movers, 8U);
  // The first mask is older than the first velocity; the third one, shortly after its keyframe, confirms.
  EXPECT_EQ(report.all().matched, 5U);
  EXPECT_EQ(report.tracks, 5U);
  EXPECT_EQ(report.identity_switches, 0U);
  EXPECT_LT(meanAbsolute(report.all().errors.position), 0.5);
  EXPECT_LT(meanAbsolute(report.all().errors.velocity), 1.0);
  options.masks.directory.clear();
  EXPECT_EQ(evaluate(options).all().matched, 0U) << "without masks";
}

TEST_F(ObjectMasksTest, RegionAndReturnsAreOneObject) {
  ObjectEvaluationOptions options = this->options();
  options.objects.mask_starts_tracks = true;
  const ObjectReport with = evaluate(options);
  options.masks.directory.clear();
  const ObjectReport without = evaluate(options);
  EXPECT_EQ(with.all().matched, 7U);
  EXPECT_EQ(without.all().matched, 7U);
  EXPECT_EQ(with.tracks, without.tracks);
  EXPECT_EQ(with.duplicates, 0U);
  EXPECT_EQ(with.identity_switches, 0U);
  // 0.130 m and 0.137 m
  EXPECT_LT(meanAbsolute(with.all().errors.position), 0.97 * meanAbsolute(without.all().errors.position));
}

TEST_F(ObjectMasksTest, MasksSpeakOnceTheyAreKnown) {
  ObjectEvaluationOptions options = this->options();
  blindRadar(options);
  options.objects.mask_starts_tracks = true;
  options.objects.tracker.max_lag = 1.0;
  options.objects.tracker.min_coast = options.objects.tracker.max_coast =
      options.objects.tracker.max_weak_time = 1.5;
  EXPECT_EQ(evaluate(options).all().matched, 5U);
  options.masks.delay = 0.55;
  EXPECT_EQ(evaluate(options).all().matched, 4U) << "the third mask is known after the fourth keyframe";
  options.objects.tracker.max_lag = 0.5;
  test::expectRefusal([&] { evaluate(options); }, {"0.55", "max_lag"});
}

TEST_F(ObjectMasksTest, SmallRegionsAreLeftOut) {
  ObjectEvaluationOptions options = this->options();
  blindRadar(options);
  options.objects.mask_starts_tracks = true;
  options.objects.regions.min_pixels = 6000;  // 100 px x 60 px on a grid 800 px wide
  EXPECT_EQ(evaluate(options).all().matched, 5U);
  options.objects.regions.min_pixels = 6001;
  EXPECT_EQ(evaluate(options).all().matched, 0U);
}

TEST_F(ObjectMasksTest, WhatIsMissingIsNamed) {
  ObjectEvaluationOptions options = this->options();
  options.masks.directory = folder_.path().string();
  test::expectRefusal<dataset::DatasetError>([&] { evaluate(options); },
                                             {folder_.path().string() + ":", "CAM_FRONT", "scene-0001"});
  options = this->options();
  options.masks.channel = "CAM_ROOF";
  test::expectRefusal<dataset::DatasetError>([&] { evaluate(options); }, {"CAM_ROOF"});
  options = this->options();
  options.depth_input.depth_directory = masks().string() + "/none";
  test::expectRefusal<dataset::DatasetError>([&] { evaluate(options); }, {masks().string() + "/none"});
  options.depth.depth.backend = "sonar";
  test::expectRefusal([&] { evaluate(options); }, {"sonar"});
}

}  // namespace
}  // namespace radar_dot::evaluation
