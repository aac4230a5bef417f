// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <string>

#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/tool_run.h"

namespace radar_dot {
namespace {

void expectRefusal(const std::string& arguments, const std::string& part) {
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "evaluate_segmentation", part);
}

TEST(EvaluateSegmentation, BadInputGetsOneLineAndANonZeroExit) {
  const test::NuscenesFixture fixture;
  const std::string dataroot = "--dataroot " + fixture.dataroot().string();
  expectRefusal("", "--dataroot");
  expectRefusal("--dataroot /nowhere", "/nowhere");
  expectRefusal(dataroot + " --scenes scene-9999", "scene-9999");
  expectRefusal("--dataroot /nowhere --flow-backend telepathy", "telepathy");  // before anything is read
  expectRefusal("--dataroot /nowhere --look-back --score paper", "look_back");
  expectRefusal(dataroot + " --jobs 0", "--jobs");
  expectRefusal("--merge /nowhere.json", "/nowhere.json");
  expectRefusal(dataroot + " --json same --csv same", "differ");
  expectRefusal(dataroot + " --mask-max-age -1", "--mask-max-age");
  expectRefusal(dataroot + " --mask-to-velocity --velocity ground_truth", "--mask-to-velocity");
  expectRefusal(dataroot + " --compare-loop --velocity ground_truth", "--compare-loop");
}

TEST(EvaluateSegmentation, ComparesTheLoopAndMergesComparisons) {
  const test::NuscenesFixture fixture;
  const test::TemporaryFolder folder;
  const std::string json = (folder.path() / "loop.json").string();
  const test::Outcome outcome =
      test::runCommand(std::string(TOOL) + " --dataroot " + fixture.dataroot().string() +
                       " --scenes scene-0001 --max-pairs 2 --working-width 160 --compare-loop --json " +
                       json + " --save-masks " + (folder.path() / "masks").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* line : {"neither ", "mask_to_velocity ", "radar_to_mask ", "both "})
    EXPECT_NE(outcome.text.find(line), std::string::npos) << outcome.text;
  EXPECT_NE(test::readFile(json).find("\"loop\": ["), std::string::npos);
  const auto masks = std::filesystem::directory_iterator(folder.path() / "masks");
  EXPECT_EQ(std::distance(begin(masks), end(masks)), 2);
  const test::Outcome merged = test::runCommand(std::string(TOOL) + " --merge " + json);
  EXPECT_EQ(merged.exit_code, 0) << merged.text;
  // The progress of the run is in its text, too.
  EXPECT_NE(outcome.text.find(merged.text), std::string::npos) << outcome.text << merged.text;
}

TEST(EvaluateSegmentation, AReportRepeatsItsRun) {
  const test::NuscenesFixture fixture;
  test::expectReportRepeatsRun(
      TOOL, "--dataroot " + fixture.dataroot().string() +
                " --scenes scene-0001 --max-pairs 2 --working-width 160 --best --memory 0.3 "
                "--depth-std 0.21");
}

// The paper's score and the defaults, on real images, with whatever flow is at hand.
TEST(EvaluateSegmentation, FindsRealMovers) {
  const std::string dataroot = std::string(RADAR_DOT_SHARED_DATA) + "/nuscenes_mini_real";
  if (!std::filesystem::exists(dataroot)) GTEST_SKIP() << dataroot << " is not there";
  const std::filesystem::path csv =
      std::filesystem::temp_directory_path() / "radar_dot_real_segmentation.csv";
  const test::Outcome outcome = test::runCommand(std::string(TOOL) + " --dataroot " + dataroot +
                                                 " --scenes scene-0103 --max-pairs 6 --csv " + csv.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("scene-0103"), std::string::npos) << outcome.text;
  EXPECT_TRUE(std::filesystem::exists(csv));
  std::filesystem::remove(csv);
}

}  // namespace
}  // namespace radar_dot
