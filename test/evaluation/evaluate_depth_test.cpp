// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/tool_run.h"

namespace radar_dot {
namespace {

void expectRefusal(const std::string& arguments, const std::string& part) {
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "evaluate_depth", part);
}

TEST(EvaluateDepth, BadInputGetsOneLineAndANonZeroExit) {
  const test::NuscenesFixture fixture;
  const std::string dataroot = "--dataroot " + fixture.dataroot().string();
  expectRefusal("", "--dataroot");
  expectRefusal("--dataroot /nowhere", "/nowhere");
  expectRefusal(dataroot + " --scenes scene-9999", "scene-9999");
  expectRefusal(dataroot + " --max-images -1", "--max-images");
  expectRefusal(dataroot + " --truth radar", "--truth is 'radar'");
  expectRefusal("--dataroot /nowhere --depth-backend stereo", "stereo");  // before anything is read
  expectRefusal(dataroot + " --json same --csv same", "differ");
  const test::Outcome outcome = test::runCommand(std::string(TOOL) + " " + dataroot);
  EXPECT_EQ(outcome.exit_code, 1);  // the reader of images may say something of its own before
  EXPECT_NE(outcome.text.find("evaluate_depth: " + fixture.dataroot().string() + "/ground_truth/depth"),
            std::string::npos)
      << outcome.text;
  expectRefusal(dataroot + " --truth lidar --scenes scene-0002", "LIDAR_TOP");
}

// The fixture has a lidar sweep for the first of its images.
TEST(EvaluateDepth, WritesTableJsonAndCsv) {
  const test::NuscenesFixture fixture;
  const test::TemporaryFolder folder;
  const std::string json = (folder.path() / "out.json").string();
  const std::string csv = (folder.path() / "out.csv").string();
  const test::Outcome outcome =
      test::runCommand(std::string(TOOL) + " --dataroot " + fixture.dataroot().string() +
                       " --truth lidar --working-width 400 --json " + json + " --csv " + csv);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("scene-0001          1         3"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("scene-0002          0         4"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("Overall             1         7"), std::string::npos) << outcome.text;
  EXPECT_NE(test::readFile(json).find("\"without_truth\": 7"), std::string::npos);
  EXPECT_NE(test::readFile(csv).find("\noverall,"), std::string::npos);
}

}  // namespace
}  // namespace radar_dot
