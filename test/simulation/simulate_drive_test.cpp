// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>

#include "fixtures/files.h"
#include "fixtures/tool_run.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;

using test::Outcome;

Outcome runTool(const std::string& arguments) {
  return test::runCommand(std::string(TOOL) + " " + arguments);
}

void expectRefusal(const std::string& arguments, const std::string& part) {
  test::expectOneLineRefusal(std::string(TOOL) + " " + arguments, "simulate_drive", part);
}

const std::string kQuick =
    " --duration 0.5 --width 128 --height 72 --lidar-rate 0 --ground-truth none --frames keyframes ";

TEST(SimulateDrive, RefusesWhatMakesNoSenseAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const std::string output = "--output " + (folder.path() / "drive").string();
  expectRefusal("", "--output");
  expectRefusal(output + " --duration 0", "duration");
  expectRefusal(output + " --duration nan", "duration");
  expectRefusal(output + " --suite maxi", "mini");
  expectRefusal(output + " --scenarios volcano", "crossing");
  expectRefusal(output + " --scenarios crossing --suite mini", "--suite");
  expectRefusal(output + " --width 3", "--width is 3, must be between 64 and 8192 px");
  expectRefusal(output + " --cameras CAM_TOP", "CAM_FRONT");
  expectRefusal(output + " --camera-rate 1", "--camera-rate is 1");
  expectRefusal(output + " --radar-rate 1", "--radar-rate is 1 Hz; it must be at least 2 Hz, or 0");
  expectRefusal(output + " --frames some", "frames");
  expectRefusal(output + " --threads -1", "threads");
  expectRefusal("--output /proc/drive" + kQuick, "/proc");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SimulateDrive, ReplacesItsOwnOutputOnlyWhenForced) {
  const test::TemporaryFolder folder;
  const std::string output = "--output " + (folder.path() / "drive").string() + kQuick;
  ASSERT_EQ(runTool(output).exit_code, 0);
  const std::string before = test::readFile(folder.path() / "drive/v1.0-sim/sample_data.json");
  expectRefusal(output, "--force");
  const Outcome forced = runTool(output + " --force --seed 5");
  EXPECT_EQ(forced.exit_code, 0) << forced.text;
  EXPECT_NE(test::readFile(folder.path() / "drive/v1.0-sim/sample_data.json"), before);
  test::writeFile(folder.path() / "drive/thesis.txt", "years of work");
  expectRefusal(output + " --force", "thesis.txt");
  EXPECT_EQ(test::readFile(folder.path() / "drive/thesis.txt"), "years of work");
}

TEST(SimulateDrive, OneScenarioTwiceIsRefused) {
  const test::TemporaryFolder folder;
  expectRefusal("--output " + (folder.path() / "drive").string() + kQuick + "--scenarios night,night",
                "night");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SimulateDrive, AnInterruptedRunLeavesNothing) {
  const test::TemporaryFolder folder;
  const std::string output = (folder.path() / "drive").string();
  const pid_t child = fork();
  if (child == 0) {
    std::freopen("/dev/null", "w", stderr);
    execl(TOOL, TOOL, "--output", output.c_str(), "--duration", "60", static_cast<char*>(nullptr));
    _exit(127);
  }
  // Until it has begun to write.
  for (int i = 0; i < 600 && fs::is_empty(folder.path()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(fs::is_empty(folder.path()));
  EXPECT_FALSE(fs::exists(output)) << "nothing that looks complete";
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGINT);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SimulateDrive, ListsItsScenarios) {
  const Outcome outcome = runTool("--list");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 10);
  EXPECT_NE(outcome.text.find("night"), std::string::npos);
}

TEST(CompareRadar, ADatarootEqualsItself) {
  const test::TemporaryFolder folder;
  const std::string dataroot = (folder.path() / "drive").string();
  ASSERT_EQ(runTool("--output " + dataroot + kQuick).exit_code, 0);
  const auto [exit_code, text] =
      test::runCommand(std::string("/usr/bin/python3 ") + COMPARE_RADAR + " --real " + dataroot +
                       " --real-version v1.0-sim --simulated " + dataroot);
  EXPECT_EQ(exit_code, 0) << text;
  const std::size_t all = text.find("\n  all ", text.find("simulated / real (bar"));
  ASSERT_NE(all, std::string::npos) << text;
  const std::string line = text.substr(all + 1, text.find('\n', all + 1) - all - 1);
  const auto first = line.find("1.000");
  ASSERT_NE(first, std::string::npos) << line;
  EXPECT_NE(line.find("1.000", first + 1), line.rfind("1.000")) << "three ratios: " << line;
}

}  // namespace
}  // namespace radar_dot
