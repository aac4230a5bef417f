// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The command-line tool as its user sees it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "bag/bag_reading.h"
#include "fixtures/nuscenes_fixture.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;
using test::NuscenesFixture;

struct Outcome {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string output;
  std::string errors;
};

/// The tool, running.
class Tool {
 public:
  explicit Tool(std::vector<std::string> arguments, rlim_t file_size_limit = RLIM_INFINITY) {
    arguments.insert(arguments.begin(), TOOL);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    test::writeFile(folder_.path() / "output", "");
    test::writeFile(folder_.path() / "errors", "");
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(::open((folder_.path() / "output").c_str(), O_WRONLY), STDOUT_FILENO);
      ::dup2(::open((folder_.path() / "errors").c_str(), O_WRONLY), STDERR_FILENO);
      const rlimit limit{file_size_limit, file_size_limit};
      if (file_size_limit != RLIM_INFINITY) ::setrlimit(RLIMIT_FSIZE, &limit);
      ::execv(words[0], words.data());
      ::_exit(127);
    }
  }

  void kill(int signal) const { ::kill(process_, signal); }

  Outcome wait() const {
    int status = 0;
    ::waitpid(process_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, test::readFile(folder_.path() / "output"),
            test::readFile(folder_.path() / "errors")};
  }

 private:
  test::TemporaryFolder folder_;
  pid_t process_ = -1;
};

Outcome run(const std::vector<std::string>& arguments) { return Tool(arguments).wait(); }

std::ptrdiff_t linesOf(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

class NuscenesToBag : public testing::Test {
 protected:
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"--dataroot", fixture_.dataroot().string(), "--output",
                                    output().string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  fs::path output() const { return folder_.path() / "bags"; }
  bool leftNothing() const { return !fs::exists(output()) || fs::is_empty(output()); }

  /// One line that begins with the tool's name and holds every part.
  void expectRefusal(const std::vector<std::string>& words, int exit_code,
                     const std::vector<std::string>& parts) const {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.errors;
    EXPECT_EQ(outcome.errors.rfind("nuscenes_to_bag: ", 0), 0U) << outcome.errors;
    EXPECT_EQ(linesOf(outcome.errors), 1) << outcome.errors;
    for (const std::string& part : parts)
      EXPECT_NE(outcome.errors.find(part), std::string::npos) << outcome.errors;
  }

  NuscenesFixture fixture_;
  test::TemporaryFolder folder_;
};

TEST_F(NuscenesToBag, ConvertsAllScenesWithALineEach) {
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(linesOf(outcome.output), 2) << outcome.output;
  EXPECT_EQ(outcome.errors, "");
  for (const char* scene : {NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene}) {
    test::BagReader bag(output() / (std::string(scene) + ".bag"));
    EXPECT_EQ(bag.counts().count("/ground_truth/dynamic_mask/compressed"), 1U);
    EXPECT_NE(outcome.output.find(std::to_string(bag.view().size()) + " messages"), std::string::npos);
  }
}

TEST_F(NuscenesToBag, OptionsChooseScenesChannelsMasksAndCompression) {
  const Outcome outcome =
      run(arguments({"--scenes", NuscenesFixture::kTurningScene, "--channels", "RADAR_FRONT,CAM_FRONT",
                     "--no-masks", "--quiet", "--compression", "lz4"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.output + outcome.errors, "");
  EXPECT_FALSE(fs::exists(output() / "scene-0001.bag"));
  const auto counts = test::BagReader(output() / "scene-0002.bag").counts();
  EXPECT_EQ(counts.count("/radar_front"), 1U);
  EXPECT_EQ(counts.count("/cam_front/image/compressed"), 1U);
  EXPECT_EQ(counts.count("/radar_front_left"), 0U);
  EXPECT_EQ(counts.count("/ground_truth/dynamic_mask/compressed"), 0U);
}

TEST_F(NuscenesToBag, WarnsOncePerChannelOfMissingFiles) {
  fs::remove_all(fixture_.dataroot() / "samples/CAM_FRONT");
  fs::remove_all(fixture_.dataroot() / "sweeps/RADAR_FRONT");
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(linesOf(outcome.errors), 2) << outcome.errors;
  EXPECT_NE(outcome.errors.find("CAM_FRONT: none of the 8 files is on disk"), std::string::npos)
      << outcome.errors;
  EXPECT_NE(outcome.errors.find("files are not on disk; converted the others"), std::string::npos);
}

TEST_F(NuscenesToBag, BadInputGetsOneLine) {
  expectRefusal({"--dataroot", "/nowhere", "--output", output()}, 1, {"/nowhere"});
  expectRefusal(arguments({"--scenes", "scene-9999"}), 1, {"scene-9999", "scene-0001", "scene-0002"});
  expectRefusal(arguments({"--channels", "RADAR_ROOF"}), 1, {"RADAR_ROOF", "RADAR_FRONT_LEFT"});
  expectRefusal(arguments({"--version", "v9.9"}), 1, {"v9.9"});
  EXPECT_TRUE(leftNothing());
}

TEST_F(NuscenesToBag, WrongUsageIsToldApart) {
  expectRefusal({}, 2, {"--dataroot"});
  expectRefusal(arguments({"--compression", "zip"}), 2, {"zip", "lz4"});
  expectRefusal(arguments({"--all", "--scenes", "scene-0001"}), 2, {"--all"});
  expectRefusal(arguments({"--unknown"}), 2, {"--unknown"});
  EXPECT_EQ(run({"--help"}).exit_code, 0);
}

TEST_F(NuscenesToBag, RefusesToOverwriteUnlessForced) {
  test::writeFile(output() / "scene-0001.bag", "precious");
  expectRefusal(arguments(), 1, {"scene-0001.bag exists already", "--force"});
  EXPECT_EQ(test::readFile(output() / "scene-0001.bag"), "precious");
  EXPECT_EQ(run(arguments({"--force"})).exit_code, 0);
  EXPECT_GT(fs::file_size(output() / "scene-0001.bag"), 1000U);
}

TEST_F(NuscenesToBag, NamesAnOutputThatCannotBeWritten) {
  test::writeFile(folder_.path() / "file", "");
  const std::string below_file = (folder_.path() / "file/bags").string();
  expectRefusal({"--dataroot", fixture_.dataroot(), "--output", below_file}, 1, {below_file});
}

TEST_F(NuscenesToBag, AFullDiskLeavesNothing) {
  const Outcome outcome = Tool(arguments(), 50'000).wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(linesOf(outcome.errors), 1) << outcome.errors;
  EXPECT_NE(outcome.errors.find("cannot write " + (output() / "scene-0001.bag").string()), std::string::npos)
      << outcome.errors;
  EXPECT_TRUE(leftNothing());
}

TEST(NuscenesToBagInterrupted, LeavesNothing) {
  test::FixtureOptions options;
  options.samples_per_scene = 40;  // long enough to be caught at work
  const NuscenesFixture fixture(options);
  const test::TemporaryFolder folder;
  for (const int signal : {SIGINT, SIGTERM}) {
    const Tool tool({"--dataroot", fixture.dataroot(), "--output", folder.path(), "--compression", "bz2"});
    for (int i = 0; i < 10'000 && fs::is_empty(folder.path()); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_FALSE(fs::is_empty(folder.path()));
    tool.kill(signal);
    const Outcome outcome = tool.wait();
    EXPECT_EQ(outcome.exit_code, 128 + signal) << outcome.errors;
    EXPECT_NE(outcome.errors.find("interrupted"), std::string::npos) << outcome.errors;
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

}  // namespace
}  // namespace radar_dot::bag
