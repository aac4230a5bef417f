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
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "evaluate_objects", part);
}

TEST(EvaluateObjects, WritesTableJsonAndCsv) {
  const test::NuscenesFixture fixture;
  const test::TemporaryFolder folder;
  const std::string json = (folder.path() / "out.json").string();
  const std::string csv = (folder.path() / "out.csv").string();
  const test::Outcome outcome = test::runCommand(
      std::string(TOOL) + " --dataroot " + fixture.dataroot().string() + " --json " + json + " --csv " + csv);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* part : {"Precision %", "scene-0001", "scene-0002", "Overall", "vehicle"})
    EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
  EXPECT_NE(test::readFile(json).find("\"identity_switches\""), std::string::npos);
  EXPECT_NE(test::readFile(csv).find("\noverall,"), std::string::npos);
}

TEST(EvaluateObjects, AReportRepeatsItsRun) {
  const test::NuscenesFixture fixture;
  test::expectReportRepeatsRun(TOOL, "--dataroot " + fixture.dataroot().string() +
                                         " --isolated-speed 0.83 --object-returns all --weak-threshold inf");
}

TEST(EvaluateObjects, BadInputGetsOneLineAndANonZeroExit) {
  const test::NuscenesFixture fixture;
  const std::string dataroot = "--dataroot " + fixture.dataroot().string();
  expectRefusal("--dataroot /nowhere", "/nowhere");
  expectRefusal(dataroot + " --scenes scene-9999", "scene-9999");
  expectRefusal(dataroot + " --radar-channels RADAR_ROOF", "RADAR_ROOF");
  expectRefusal(dataroot + " --json same --csv same", "differ");
  expectRefusal(dataroot + " --saved-masks /nowhere/masks", "/nowhere/masks");
  expectRefusal(dataroot + " --saved-masks /nowhere/masks --mask-delay 0.5", "max-lag");
  EXPECT_EQ(test::runCommand(std::string(TOOL) + " --bad").exit_code, 2);
}

}  // namespace
}  // namespace radar_dot
