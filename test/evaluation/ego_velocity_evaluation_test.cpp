// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/ego_velocity_evaluation.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>
#include <rapidjson/pointer.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "config/config_file.h"
#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

using test::NuscenesFixture;

test::FixtureOptions longerDrive() {
  test::FixtureOptions options;
  options.samples_per_scene = 12;
  return options;
}

class Evaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fixture_ = std::make_unique<NuscenesFixture>(longerDrive());
    tables_ = std::make_unique<dataset::Tables>(dataset::Tables::load(fixture_->dataroot()));
  }
  static VelocityReport evaluate(const char* scene, const VelocityEvaluationOptions& options = {}) {
    return evaluateEgoVelocity(*tables_, tables_->findScene(scene), options);
  }

  static inline std::unique_ptr<NuscenesFixture> fixture_;
  static inline std::unique_ptr<dataset::Tables> tables_;
};

// Exact Doppler: with the right model nothing is left but single precision.
TEST_F(Evaluation, ExactRadarGivesExactFigures) {
  for (const char* scene : {NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene}) {
    const VelocityReport report = evaluate(scene);
    EXPECT_EQ(report.frames, 11U);
    EXPECT_EQ(report.refused, 0U);
    EXPECT_EQ(report.sweeps_refused, 0U);
    const ModelErrors& errors = report.models.at("planar_yaw");
    EXPECT_LT(errors.vx.value(), 5e-3) << scene;
    EXPECT_LT(errors.vy.value(), 5e-3) << scene;
    EXPECT_LT(errors.yaw_rate.value(), 1e-3) << scene;
    EXPECT_LT(report.gt_heading.driftPercent(), 0.05) << scene;
    EXPECT_LT(report.own_heading.driftPercent(), 0.2) << scene;
    EXPECT_LT(report.wheel_estimate.value(), 5e-3) << scene;
  }
}

TEST_F(Evaluation, TheFilterFollowsExactRadar) {
  VelocityEvaluationOptions options;
  options.ego_velocity.filter = true;
  for (const bool by_radar : {true, false}) {
    options.filter_radars = by_radar;
    for (const char* scene : {NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene}) {
      const VelocityReport report = evaluate(scene, options);
      EXPECT_EQ(report.filter_rejected, 0U) << scene;
      EXPECT_EQ(report.filter_starts, 1U) << scene;
      ASSERT_GT(report.filtered.vx.count, 0U);
      EXPECT_EQ(report.filtered.vx.count, report.causal.vx.count);
      EXPECT_LT(report.filtered.vx.value(), 0.02) << scene;
      EXPECT_LT(report.filtered.vy.value(), 0.02) << scene;
      EXPECT_LT(report.filtered.yaw_rate.value(), 0.005) << scene;
    }
  }
  options.ego_velocity.filter = false;
  EXPECT_EQ(evaluate(NuscenesFixture::kStraightScene, options).filtered.vx.count, 0U);
}

TEST_F(Evaluation, ThePapersOrderHoldsOnTheStraight) {
  const VelocityReport report = evaluate(NuscenesFixture::kStraightScene);
  EXPECT_LT(report.mae.at("A1").value(), 0.5 * report.mae.at("B1").value());
  EXPECT_LT(report.mae.at("A2").value(), 1e-3);
  EXPECT_LT(report.mae.at("robust").value(), 1e-3);
}

// Every return in the moving box is found; movers without a box are false alarms by definition.
TEST_F(Evaluation, DynamicLabelsFindTheBox) {
  const VelocityReport report = evaluate(NuscenesFixture::kStraightScene);
  EXPECT_GT(report.dynamic.true_positives, 20U);
  EXPECT_EQ(report.dynamic.false_negatives, 0U);
  EXPECT_GT(report.dynamic.true_negatives, 1000U);
  EXPECT_LE(report.dynamic_70m.true_positives + report.dynamic_70m.true_negatives,
            report.dynamic.true_positives + report.dynamic.true_negatives);
}

/// Masks of one grey value for every keyframe image.
void writeMasks(const std::filesystem::path& folder, const dataset::Tables& tables, double value) {
  for (const dataset::Index row :
       tables.readingsOf(tables.findScene(NuscenesFixture::kStraightScene), "CAM_FRONT")) {
    const dataset::SampleData& image = tables.sample_data[static_cast<std::size_t>(row)];
    cv::imwrite((folder / (tables.path(image).stem().string() + ".png")).string(),
                cv::Mat(90, 160, CV_8UC1, cv::Scalar(value)));
  }
}

// A mask of everything makes all that the camera sees dynamic, one of nothing changes nothing.
TEST_F(Evaluation, ReturnsInSavedMasksAreDynamic) {
  const VelocityReport without = evaluate(NuscenesFixture::kStraightScene);
  const test::TemporaryFolder folder;
  VelocityEvaluationOptions options;
  options.masks.directory = folder.path().string();
  writeMasks(folder.path(), *tables_, 0.0);
  const VelocityReport nothing = evaluate(NuscenesFixture::kStraightScene, options);
  EXPECT_EQ(nothing.dynamic.false_positives, without.dynamic.false_positives);
  EXPECT_EQ(nothing.mae.at("B1").sum, without.mae.at("B1").sum);
  writeMasks(folder.path(), *tables_, 255.0);
  const VelocityReport everything = evaluate(NuscenesFixture::kStraightScene, options);
  EXPECT_GT(everything.dynamic.false_positives, without.dynamic.false_positives + 100U);
  EXPECT_EQ(everything.dynamic.false_negatives, 0U);
  EXPECT_NE(everything.mae.at("B1").sum, without.mae.at("B1").sum);
  EXPECT_LT(everything.mae.at("A2").value(), 1e-3);  // the other radars are enough
}

// Keyframe images are taken shortly after the scans that go with them, so that these have the mask of half a
// second before.
TEST_F(Evaluation, SavedMasksSpeakOnlyOnceKnownAndWithinTheirAge) {
  const VelocityReport without = evaluate(NuscenesFixture::kStraightScene);
  const test::TemporaryFolder folder;
  writeMasks(folder.path(), *tables_, 255.0);
  VelocityEvaluationOptions options;
  options.masks.directory = folder.path().string();
  options.masks.delay = 100.0;
  EXPECT_EQ(evaluate(NuscenesFixture::kStraightScene, options).mae.at("B1").sum, without.mae.at("B1").sum);
  options.masks.delay =
      0.5;  // at the middle of a pair of keyframes the mask is three quarters of a second old
  options.ego_velocity.mask_max_age = 0.6;
  EXPECT_EQ(evaluate(NuscenesFixture::kStraightScene, options).mae.at("B1").sum, without.mae.at("B1").sum);
  options.ego_velocity.mask_max_age = 1.1;
  EXPECT_NE(evaluate(NuscenesFixture::kStraightScene, options).mae.at("B1").sum, without.mae.at("B1").sum);
  options.ego_velocity.mask_max_age = -1.0;
  test::expectRefusal([&] { evaluate(NuscenesFixture::kStraightScene, options); }, {"mask_max_age", "-1"});
}

TEST_F(Evaluation, MasksOfNothingAreNamed) {
  const test::TemporaryFolder folder;
  VelocityEvaluationOptions options;
  options.masks.directory = folder.path().string();
  const auto expect = [&options](const std::vector<std::string>& parts) {
    test::expectRefusal<dataset::DatasetError>(
        [&options] { evaluate(NuscenesFixture::kStraightScene, options); }, parts);
  };
  expect({folder.path().string(), "CAM_FRONT", NuscenesFixture::kStraightScene});
  options.masks.channel = "CAM_ROOF";
  expect({"CAM_ROOF", NuscenesFixture::kStraightScene});
}

// One forward radar cannot tell sideslip from yaw: no yaw-rate figure, but vx.
TEST_F(Evaluation, OneRadarReportsWhatItCanSee) {
  VelocityEvaluationOptions options;
  options.radar_channels = {"RADAR_FRONT"};
  const VelocityReport report = evaluate(NuscenesFixture::kStraightScene, options);
  EXPECT_EQ(report.refused, 0U);
  EXPECT_LT(report.models.at("planar_yaw").vx.value(), 5e-3);
  EXPECT_EQ(report.models.at("planar_yaw").yaw_rate.count, 0U);
  EXPECT_LT(report.gt_heading.driftPercent(), 0.1);
}

// A mount turned away from its calibration shows up as the turn back, and only there.
TEST_F(Evaluation, AMountThatIsTurnedIsFound) {
  VelocityEvaluationOptions options;
  options.mount_yaw_corrections = {"RADAR_FRONT_LEFT=0.02"};
  VelocityReport report = evaluate(NuscenesFixture::kStraightScene, options);
  EXPECT_NEAR(report.mounts.at("RADAR_FRONT_LEFT").yaw(), -0.02, 1e-3);
  EXPECT_NEAR(report.mounts.at("RADAR_BACK_RIGHT").yaw(), 0.0, 1e-3);

  // The mount of its entry counts instead of the calibration.
  options = {};
  RadarEntry& left = options.ego_velocity.radars["left"];
  left.topic = "radar_front_left";
  left.mount_xyz = std::array<double, 3>{2.422, 0.8, 0.78};
  left.mount_rpy = std::array<double, 3>{0.0, 0.0, 88.4 * M_PI / 180.0 + 0.02};
  report = evaluate(NuscenesFixture::kStraightScene, options);
  EXPECT_NEAR(report.mounts.at("RADAR_FRONT_LEFT").yaw(), -0.02, 1e-3);
}

// Poses of another time are no ground truth.
TEST_F(Evaluation, PosesThatDoNotCoverTheSceneAreRefused) {
  dataset::Tables shifted = dataset::Tables::load(fixture_->dataroot());
  for (auto& pose : shifted.ego_poses) pose.timestamp_us -= 1'000'000'000;
  test::expectRefusal<dataset::DatasetError>(
      [&] { evaluateEgoVelocity(shifted, shifted.findScene(NuscenesFixture::kStraightScene)); },
      {"ego_pose.json"});
}

TEST_F(Evaluation, KeyframesOutOfOrderAreRefused) {
  dataset::Tables same = dataset::Tables::load(fixture_->dataroot());
  for (auto& sample : same.samples) sample.timestamp_us = same.samples[0].timestamp_us;
  EXPECT_THROW(evaluateEgoVelocity(same, same.findScene(NuscenesFixture::kStraightScene)),
               dataset::DatasetError);
}

// Without annotations there is nothing to compare the labels with, which is not a failure.
TEST_F(Evaluation, WithoutAnnotationsThereIsNoLabelFigure) {
  dataset::LoadOptions load;
  load.annotations = false;
  const dataset::Tables bare = dataset::Tables::load(fixture_->dataroot(), load);
  const VelocityReport report = evaluateEgoVelocity(bare, bare.findScene(NuscenesFixture::kStraightScene));
  EXPECT_TRUE(std::isnan(report.dynamic.f1()));
  EXPECT_TRUE(std::isnan(report.dynamic.precision()));
  EXPECT_GT(report.frames, 0U);
}

TEST_F(Evaluation, AnUnknownChannelIsNamedWithTheRadarsAtHand) {
  VelocityEvaluationOptions options;
  options.radar_channels = {"RADAR_REAR"};
  test::expectRefusal<dataset::DatasetError>([&] { evaluate(NuscenesFixture::kStraightScene, options); },
                                             {"RADAR_REAR", "RADAR_FRONT_LEFT"});
}

TEST_F(Evaluation, JsonHasTheDocumentedKeys) {
  const VelocityReport report = evaluate(NuscenesFixture::kTurningScene);
  rapidjson::Document json;
  json.Parse(formatJson({report}, report).c_str());
  ASSERT_FALSE(json.HasParseError());
  for (const std::string path :
       {"mae/B1", "mae/A1", "mae/B2", "mae/A2", "models/planar_yaw/vx_mae", "models/planar_yaw/vy_mae",
        "models/planar_yaw/velocity_mae", "models/planar_yaw/yaw_rate_mae", "causal/single/yaw_rate_mae",
        "causal/filter/velocity_mae", "causal/filter/yaw_rate_mae", "trajectory/gt_heading/ate_rmse",
        "trajectory/own_heading/drift_percent", "dynamic/precision", "dynamic/recall", "dynamic/f1",
        "dynamic/f1_70m"}) {
    const rapidjson::Value* value = rapidjson::Pointer(("/overall/" + path).c_str()).Get(json);
    EXPECT_TRUE(value != nullptr && value->IsNumber()) << path;
  }
  const rapidjson::Value& planar = json["overall"]["models"]["planar"];
  EXPECT_TRUE(planar["yaw_rate_mae"].IsNull());
  EXPECT_GT(planar["vy_mae"].GetDouble(), 0.1) << "there is no yaw rate in it, and the scene turns";
  EXPECT_GT(planar["velocity_mae"].GetDouble(), planar["vy_mae"].GetDouble());
  EXPECT_LT(planar["velocity_mae"].GetDouble(), planar["vx_mae"].GetDouble() + planar["vy_mae"].GetDouble());
}

class RealData : public ::testing::Test {
 protected:
  /// The merged report of every scene, as the tool evaluates them.
  void evaluateScenes(bool filter, const std::function<void(const VelocityReport&)>& check,
                      MotionModel model = MotionModel::kPlanarYaw,
                      const std::vector<std::string>& channels = {}) {
    const std::filesystem::path dataroot =
        std::filesystem::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real";
    if (!std::filesystem::exists(dataroot)) GTEST_SKIP() << "no real data under " << dataroot;
    const dataset::Tables tables = dataset::Tables::load(dataroot);
    VelocityEvaluationOptions options;
    Configuration nuscenes;
    readConfigFile(NUSCENES_CONFIG, sectionsOf(nuscenes));
    options.ego_velocity = nuscenes.ego_velocity;
    options.ego_velocity.filter = filter;
    options.ego_velocity.estimator.model = model;
    options.radar_channels = channels;
    for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
      const VelocityReport report = evaluateEgoVelocity(tables, static_cast<dataset::Index>(scene), options);
      check(report);
      overall_ += report;
    }
  }
  VelocityReport overall_;
};

// The bars of the method on real radar, so that no change loses them unnoticed.
TEST_F(RealData, MeetsItsFigures) {
  evaluateScenes(false, [](const VelocityReport& report) {
    EXPECT_LE(report.gt_heading.driftPercent(), 1.0) << report.scene;
    EXPECT_EQ(report.sweeps_refused, 0U) << report.scene;
  });
  if (IsSkipped()) return;
  EXPECT_LT(overall_.mae.at("A1").value(), 0.6 * overall_.mae.at("B1").value());
  double best = 1e9;
  for (const auto& [variant, error] : overall_.mae) best = std::min(best, error.value());
  EXPECT_LE(best, 0.115);
  EXPECT_LE(overall_.models.at("planar_yaw").vx.value(), 0.057);
  EXPECT_LE(overall_.models.at("planar_yaw").yaw_rate.value(), 0.0135);
  EXPECT_GE(overall_.dynamic_70m.f1(), 0.82);
  EXPECT_GE(overall_.dynamic.f1(), 0.77);
  EXPECT_LE(overall_.gt_heading.driftPercent(), 1.0);
  EXPECT_EQ(overall_.refused, 0U);
}

TEST_F(RealData, TheFilterMeetsItsFigures) {
  evaluateScenes(true, [](const VelocityReport& report) {
    EXPECT_EQ(report.filter_starts, 1U) << report.scene;
    // 0.28 m after the 27 m of scene-0757.
    EXPECT_LE(report.gt_heading.driftPercent(), 1.1) << report.scene;
    EXPECT_LE(report.own_heading.driftPercent(), 7.0) << report.scene;
  });
  if (IsSkipped()) return;
  EXPECT_LE(overall_.filtered.vx.value(), 0.055);
  EXPECT_LE(overall_.filtered.vy.value(), 0.036);
  EXPECT_LE(overall_.filtered.yaw_rate.value(), 0.0087);
  EXPECT_LE(overall_.gt_heading.driftPercent(), 0.45);
  EXPECT_LE(overall_.own_heading.driftPercent(), 3.5);
}

TEST_F(RealData, TheFilterHonoursTheAckermannModel) {
  for (const std::vector<std::string>& channels : {std::vector<std::string>{"RADAR_FRONT"}, {}}) {
    overall_ = VelocityReport();
    evaluateScenes(
        true, [](const VelocityReport&) {}, MotionModel::kAckermann, channels);
    if (IsSkipped()) return;
    EXPECT_LE(overall_.filtered.yaw_rate.value(), overall_.causal.yaw_rate.value()) << channels.size();
    EXPECT_LE(overall_.filtered.normalised_yaw_rate.value(), 1.0) << channels.size();
    EXPECT_LE(overall_.filtered.normalised_vy.value(), 1.0) << "within sideslip_std";
    EXPECT_LE(overall_.causal.normalised_yaw_rate.value(), 1.0) << channels.size();
  }
}

}  // namespace
}  // namespace radar_dot::evaluation
