// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The command-line tool as its user sees it.
#include <fcntl.h>
#include <fmt/format.h>
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
#include "radar_dot/dataset/tables.h"

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

TEST_F(NuscenesToBag, ConvertsAllScenesWithALineEachAndASummary) {
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(linesOf(outcome.output), 3) << outcome.output;
  EXPECT_NE(outcome.output.find("2 scenes, their bags: 2 written, 0 complete before, 0 missing"),
            std::string::npos);
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

/// Removes the sensor files of a scene, of one channel or all. @return how many
std::size_t removeFiles(const NuscenesFixture& fixture, const char* scene, const std::string& channel = "") {
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  std::size_t removed = 0;
  for (const dataset::SampleData& row : tables.sample_data)
    if (at(tables.samples, row.sample).scene == tables.findScene(scene) &&
        (channel.empty() || tables.channelOf(row) == channel))
      removed += fs::remove(tables.path(row)) ? 1 : 0;
  return removed;
}

TEST_F(NuscenesToBag, WarnsOncePerSceneOfMissingFiles) {
  const std::size_t radar = removeFiles(fixture_, "scene-0001", "RADAR_FRONT");
  removeFiles(fixture_, "scene-0001", "CAM_FRONT");
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.errors;
  EXPECT_NE(outcome.errors.find("left out: scene-0001 (sensor files): not on disk: CAM_FRONT 4 of 4"),
            std::string::npos)
      << outcome.errors;
  EXPECT_NE(outcome.errors.find(fmt::format("RADAR_FRONT {0} of {0}", radar)), std::string::npos)
      << outcome.errors;
  EXPECT_TRUE(fs::exists(output() / "scene-0001.bag"));
}

// A second run does what the first could not, and nothing else.
TEST_F(NuscenesToBag, ResumesWithPartOfTheDatasetOnDisk) {
  const NuscenesFixture whole;
  removeFiles(fixture_, "scene-0001");
  const Outcome first = run(arguments());
  EXPECT_EQ(first.exit_code, 3) << first.errors;
  EXPECT_NE(first.errors.find("left out: scene-0001: none of its "), std::string::npos) << first.errors;
  EXPECT_NE(first.output.find("2 scenes, their bags: 1 written, 0 complete before, 1 missing"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(output() / "scene-0001.bag"));
  const auto written = fs::last_write_time(output() / "scene-0002.bag");

  fs::copy(whole.dataroot(), fixture_.dataroot(),
           fs::copy_options::recursive | fs::copy_options::skip_existing);
  test::writeFile(output() / "scene-0001.bag.partial-1", "what a killed run leaves");
  const Outcome second = run(arguments());
  EXPECT_EQ(second.exit_code, 0) << second.errors;
  EXPECT_NE(second.output.find("2 scenes, their bags: 1 written, 1 complete before, 0 missing"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(output() / "scene-0001.bag.partial-1"));
  EXPECT_EQ(fs::last_write_time(output() / "scene-0002.bag"), written);
  const auto counts = test::BagReader(output() / "scene-0001.bag").counts();
  EXPECT_EQ(counts.at("/cam_front/image/compressed"), 4U);

  const auto bytes = fs::file_size(output() / "scene-0002.bag");
  ASSERT_EQ(run(arguments({"--channels", "RADAR_FRONT", "--force"})).exit_code, 0);
  EXPECT_LT(fs::file_size(output() / "scene-0002.bag"), bytes);
  const Outcome less = run(arguments({"--scenes", "scene-0002"}));
  EXPECT_EQ(less.exit_code, 1);
  EXPECT_NE(less.errors.find("sensor files that are on disk now"), std::string::npos) << less.errors;
}

TEST_F(NuscenesToBag, ABrokenFileCostsItsSceneAlone) {
  const dataset::Tables tables = dataset::Tables::load(fixture_.dataroot());
  const fs::path broken = tables.path(at(tables.sample_data, tables.readingsOf(0, "CAM_FRONT")[2]));
  const fs::path whole = output() / "whole.jpg";
  fs::create_directories(output());
  fs::copy_file(broken, whole);
  const std::uintmax_t image_size = fs::file_size(broken);
  test::writeFile(broken, "<html>404 Not Found</html>");
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.errors;
  EXPECT_NE(outcome.errors.find("left out: scene-0001: " + broken.string() + ": is neither a JPEG nor a PNG"),
            std::string::npos)
      << outcome.errors;
  EXPECT_FALSE(fs::exists(output() / "scene-0001.bag"));
  EXPECT_TRUE(fs::exists(output() / "scene-0002.bag"));

  // Empty, and half of a JPEG, which can be decoded.
  for (const std::uintmax_t size : {std::uintmax_t{0}, image_size / 2}) {
    fs::copy_file(whole, broken, fs::copy_options::overwrite_existing);
    fs::resize_file(broken, size);
    const Outcome again = run(arguments({"--force"}));
    EXPECT_EQ(again.exit_code, 3) << again.errors;
    EXPECT_NE(again.errors.find(broken.string() + ": is no whole image"), std::string::npos) << again.errors;
  }
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
  const Outcome outcome = run(arguments());
  EXPECT_EQ(outcome.exit_code, 3);
  for (const char* part : {"scene-0001.bag exists already and is no complete bag", "--force"})
    EXPECT_NE(outcome.errors.find(part), std::string::npos) << outcome.errors;
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
