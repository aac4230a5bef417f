// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

#include "evaluation/flow_truth.h"
#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/tool_run.h"

namespace radar_dot {
namespace {

void expectRefusal(const std::string& arguments, const std::string& part) {
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "evaluate_flow", part);
}

TEST(EvaluateFlow, BadInputGetsOneLineAndANonZeroExit) {
  const test::NuscenesFixture fixture;
  const std::string dataroot = "--version v1.0-mini --dataroot " + fixture.dataroot().string();
  expectRefusal("", "--dataroot");
  expectRefusal("--dataroot /nowhere", "/nowhere");
  expectRefusal(dataroot, "ground_truth/keyframe_flow: is not there");
  expectRefusal(dataroot + " --scenes scene-9999", "scene-9999");
  expectRefusal("--dataroot /nowhere --flow-backend telepathy", "telepathy");  // before anything is read
  expectRefusal(dataroot + " --pairs triplets", "--pairs is 'triplets'");
  expectRefusal(dataroot + " --json same --csv same", "differ");
  expectRefusal(dataroot + " --first a.png --second b.png --flow-truth c.png", "--dataroot");
  expectRefusal("--first a.png", "--second");
  expectRefusal("--first a.png --second b.png", "--flow-truth");
  expectRefusal("--first a.png --second b.png --flow-truth c.png", "a.png: is not there");
  expectRefusal("--first a.png --second b.png --flow-truth c.png --pairs next", "--pairs");
  expectRefusal("--first a.png --second b.png --flow-truth c.png --initialisation temporal", "single pair");
  EXPECT_EQ(test::runCommand(std::string(TOOL) + " --bad").exit_code, 2);
}

TEST(EvaluateFlow, WritesTableJsonAndCsv) {
  test::FixtureOptions few;
  few.samples_per_scene = 2;
  const test::NuscenesFixture fixture(few);
  test::FixtureFlow::write(fixture);
  const test::TemporaryFolder folder;
  const std::string json = (folder.path() / "out.json").string();
  const std::string csv = (folder.path() / "out.csv").string();
  const test::Outcome outcome = test::runCommand(
      std::string(TOOL) + " --dataroot " + fixture.dataroot().string() +
      " --version v1.0-mini --preset ultrafast --working-width 160 --json " + json + " --csv " + csv);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* part :
       {"px of the full image", "scene-0001          1", "scene-0002          1", "Overall             2"})
    EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
  EXPECT_NE(test::readFile(json).find("\"pairs\": 2"), std::string::npos);
  EXPECT_NE(test::readFile(csv).find("\noverall,"), std::string::npos);
}

/// Two equal images of noise, in which DIS finds no motion.
class EvaluateFlowPair : public ::testing::Test {
 protected:
  EvaluateFlowPair() {
    cv::Mat noise(90, 160, CV_8UC1);
    cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 256);
    test::writeImage(folder_.path() / "one.png", noise);
    test::writeImage(folder_.path() / "two.png", noise);
    test::writeFlow(folder_.path() / "flow.png", cv::Mat(90, 160, CV_32FC2, cv::Scalar(3.0, 4.0)));
  }
  std::string command() const {
    const std::string folder = folder_.path().string();
    return std::string(TOOL) + " --first " + folder + "/one.png --second " + folder +
           "/two.png --flow-truth " + folder + "/flow.png";
  }
  test::TemporaryFolder folder_;
};

TEST_F(EvaluateFlowPair, ThePairsErrorIsTheTruthsLength) {
  const std::string json = (folder_.path() / "out.json").string();
  for (const char* options : {"", " --working-width 80", " --preset fine --forward-backward"}) {
    SCOPED_TRACE(options);
    const test::Outcome outcome = test::runCommand(command() + options + " --json " + json);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("one                 1      5.000"), std::string::npos) << outcome.text;
    EXPECT_NE(test::readFile(json).find("\"fl_all\": 1.0"), std::string::npos);
  }
}

TEST_F(EvaluateFlowPair, RefusesWhatDoesNotFit) {
  const auto expect = [this](const std::string& options, const std::string& part) {
    test::expectOneLineRefusal(command() + options, "evaluate_flow", part);
  };
  expect(" --flow-backend telepathy", "telepathy");
  expect(" --preset best", "--preset is 'best'");
  expect(" --working-width 20", "too small");
  test::writeFlow(folder_.path() / "flow.png", cv::Mat(45, 80, CV_32FC2, cv::Scalar(0.0, 0.0)));
  expect("", "is 80x45 px, the first image 160x90");
  test::writeImage(folder_.path() / "flow.png", cv::Mat::zeros(90, 160, CV_8UC1));
  expect("", "KITTI");
}

}  // namespace
}  // namespace radar_dot
