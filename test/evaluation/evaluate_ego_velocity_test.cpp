// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidjson/document.h>
#include <sys/stat.h>

#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/tool_run.h"

namespace radar_dot {
namespace {

using test::Outcome;

Outcome runTool(const std::string& arguments) {
  return test::runCommand(std::string(TOOL) + " " + arguments);
}

class EvaluateEgoVelocity : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { fixture_ = std::make_unique<test::NuscenesFixture>(); }
  static void TearDownTestSuite() { fixture_.reset(); }
  static std::string dataroot() { return "--dataroot " + fixture_->dataroot().string(); }
  static std::unique_ptr<test::NuscenesFixture> fixture_;
};
std::unique_ptr<test::NuscenesFixture> EvaluateEgoVelocity::fixture_;

TEST_F(EvaluateEgoVelocity, WritesTableJsonAndCsv) {
  const std::filesystem::path json = fixture_->dataroot() / "out.json";
  const std::filesystem::path csv = fixture_->dataroot() / "out.csv";
  const Outcome outcome = runTool(dataroot() + " --scenes scene-0001,scene-0002 --json " + json.string() +
                                  " --csv " + csv.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("overall"), std::string::npos);
  rapidjson::Document report;
  report.Parse(test::readFile(json).c_str());
  ASSERT_FALSE(report.HasParseError());
  EXPECT_STREQ(report["parameters"]["tool"].GetString(), "evaluate_ego_velocity");
  EXPECT_STREQ(report["scenes"][1]["scene"].GetString(), "scene-0002");
  const rapidjson::Value& overall = report["overall"];
  const unsigned pairs = test::FixtureOptions().samples_per_scene - 1;
  EXPECT_EQ(overall["frames"].GetUint(), 2 * pairs);
  EXPECT_EQ(overall["refused"].GetUint(), 0U);
  EXPECT_LT(overall["models"]["planar_yaw"]["vx_mae"].GetDouble(), 1e-3) << "the fixture's radar is exact";
  std::istringstream lines(test::readFile(csv));
  std::string line;
  for (const std::string& begin :
       {std::string("scene,frames,refused,B1,"), fmt::format("scene-0001,{},0,", pairs),
        fmt::format("scene-0002,{},0,", pairs), fmt::format("overall,{},0,", 2 * pairs)}) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line.substr(0, begin.size()), begin);
  }
  EXPECT_FALSE(std::getline(lines, line));
  for (const auto& entry : std::filesystem::directory_iterator(json.parent_path()))
    EXPECT_EQ(entry.path().filename().string().find("out.json."), std::string::npos) << "a temporary file";
}

TEST_F(EvaluateEgoVelocity, TheFilterHasATableOfItsOwn) {
  const std::string title = "filtered over the sweeps";
  EXPECT_NE(runTool(dataroot() + " --mount-yaw-std 0.01").text.find(title), std::string::npos);
  EXPECT_NE(runTool(dataroot() + " --no-filter-radars").text.find(title), std::string::npos);
  EXPECT_EQ(runTool(dataroot() + " --no-filter").text.find(title), std::string::npos);
}

void expectRefusal(const std::string& arguments, const std::string& part) {
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "evaluate_ego_velocity", part);
}

TEST_F(EvaluateEgoVelocity, BadInputGetsOneLineAndANonZeroExit) {
  expectRefusal("--dataroot /nowhere", "/nowhere");
  expectRefusal(dataroot() + " --version v9.9", "v9.9");
  expectRefusal(dataroot() + " --scenes scene-9999", "scene-9999");
  expectRefusal(dataroot() + " --radar-channels RADAR_ROOF", "RADAR_ROOF");
  expectRefusal(dataroot() + " --model bicycle", "planar_yaw");
}

TEST_F(EvaluateEgoVelocity, AnUnwritableOutputIsNamed) {
  const Outcome outcome = runTool(dataroot() + " --json /nowhere/out.json");
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.text.find("evaluate_ego_velocity: /nowhere/out.json"), std::string::npos) << outcome.text;
}

TEST_F(EvaluateEgoVelocity, BadOptionsGetOneLine) {
  expectRefusal(dataroot() + " --threshold -1", "--threshold");
  expectRefusal(dataroot() + " --ransac-iterations 0", "--ransac-iterations");
  expectRefusal(dataroot() + " --doppler-scale 0", "--doppler-scale");
  expectRefusal(dataroot() + " --no-such-option", "--no-such-option");
  expectRefusal(dataroot() + " --longitudinal-jerk 0", "--longitudinal-jerk");
  expectRefusal(dataroot() + " --bearing-delay 5", "--bearing-delay");
  expectRefusal(dataroot() + " --mount-yaw-correction RADAR_FRONT", "CHANNEL=RAD");
  expectRefusal(dataroot() + " --mount-yaw-correction RADAR_FRONT=nan", "RADAR_FRONT");
  expectRefusal(dataroot() + " --mount-yaw-correction RADAR_TYPO=0.1", "RADAR_TYPO");
  expectRefusal(dataroot() + " --json same --csv same", "same");
  expectRefusal(dataroot() + " --saved-masks /nowhere", "/nowhere");
  expectRefusal(dataroot() + " --saved-masks /nowhere --mask-channel CAM_ROOF", "CAM_ROOF");
  expectRefusal(dataroot() + " --mask-max-age -1", "--mask-max-age");
}

TEST_F(EvaluateEgoVelocity, AReportRepeatsItsRun) {
  test::expectReportRepeatsRun(
      TOOL, dataroot() +
                " --scenes scene-0002 --doppler-scale 1.0021 --model ackermann --no-filter "
                "--mount-yaw-correction RADAR_FRONT=0.0123 --invalid-states '' --max-rcs 30");
}

TEST_F(EvaluateEgoVelocity, LinksAndPipesSurvive) {
  const test::TemporaryFolder folder;
  const std::filesystem::path real = folder.path() / "real.json";
  test::writeFile(real, "old");
  std::filesystem::create_symlink(real, folder.path() / "link.json");
  ASSERT_EQ(runTool(dataroot() + " --json " + (folder.path() / "link.json").string()).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.json"));
  EXPECT_EQ(test::readFile(real).front(), '{');

  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Outcome outcome =
      runTool(dataroot() + " --json " + pipe.string() + " >/dev/null & cat " + pipe.string());
  EXPECT_EQ(outcome.text.front(), '{');
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_F(EvaluateEgoVelocity, MissingFilesAreCounted) {
  test::FixtureOptions options;
  options.channels_on_disk = {"RADAR_FRONT", "RADAR_BACK_LEFT"};
  const test::NuscenesFixture partial(options);
  const std::string root = "--dataroot " + partial.dataroot().string();
  const Outcome outcome = runTool(root);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("warning: RADAR_FRONT_LEFT: "), std::string::npos) << outcome.text;
  EXPECT_EQ(outcome.text.find("warning: RADAR_FRONT: "), std::string::npos) << outcome.text;
  expectRefusal(root + " --scenes scene-0001 --radar-channels RADAR_FRONT,RADAR_FRONT_LEFT",
                "RADAR_FRONT_LEFT");
}

TEST_F(EvaluateEgoVelocity, ATruncatedPcdIsNamed) {
  const test::NuscenesFixture broken;
  for (const auto& entry :
       std::filesystem::directory_iterator(broken.dataroot() / "samples" / "RADAR_FRONT")) {
    std::filesystem::resize_file(entry.path(), 700);
  }
  const Outcome outcome = runTool("--dataroot " + broken.dataroot().string());
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.text.find("RADAR_FRONT"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("record"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace radar_dot
