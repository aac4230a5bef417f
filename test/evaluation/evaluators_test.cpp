// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidjson/document.h>
#include <sys/stat.h>

#include <filesystem>
#include <iterator>
#include <memory>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/flow_truth.h"
#include "fixtures/files.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/tool_run.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;
using test::Outcome;

std::string commandOf(const std::string& tool, const std::string& arguments) {
  return fmt::format("{}/{} {}", TOOLS, tool, arguments);
}
Outcome runTool(const std::string& tool, const std::string& arguments) {
  return test::runCommand(commandOf(tool, arguments));
}

/// Arguments, and a part of the line that refuses them.
using Refusals = std::vector<std::pair<std::string, std::string>>;
void expectRefusals(const std::string& tool, const std::string& begin, const Refusals& refusals) {
  for (const auto& [arguments, part] : refusals) {
    SCOPED_TRACE(arguments);
    test::expectOneLineRefusal(commandOf(tool, begin + " " + arguments), tool, part);
  }
}

void expectParts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

class Evaluators : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { fixture_ = std::make_unique<test::NuscenesFixture>(); }
  static std::string dataroot() { return "--version v1.0-mini --dataroot " + fixture_->dataroot().string(); }
  std::string json() const { return (folder_.path() / "out.json").string(); }
  std::string csv() const { return (folder_.path() / "out.csv").string(); }
  std::string files() const { return " --json " + json() + " --csv " + csv(); }
  rapidjson::Document report() const {
    rapidjson::Document document;
    document.Parse(test::readFile(json()).c_str());
    EXPECT_FALSE(document.HasParseError());
    return document;
  }
  /// Expects a line that begins so for the titles, for each scene and for all of them.
  void expectCsv(const std::vector<std::string>& begins) const {
    std::istringstream lines(test::readFile(csv()));
    std::string line;
    for (const std::string& begin : begins) {
      ASSERT_TRUE(std::getline(lines, line)) << begin;
      EXPECT_EQ(line.substr(0, begin.size()), begin);
    }
    EXPECT_FALSE(std::getline(lines, line)) << line;
  }

  test::TemporaryFolder folder_;
  static inline std::unique_ptr<test::NuscenesFixture> fixture_;
};

TEST_F(Evaluators, BadInputGetsOneLineAndANonZeroExit) {
  for (const std::string tool : {"evaluate_ego_velocity", "evaluate_depth", "evaluate_flow",
                                 "evaluate_objects", "evaluate_segmentation"}) {
    expectRefusals(tool, "", {{"", "--dataroot"}, {"--dataroot /nowhere", "/nowhere"}});
    expectRefusals(tool, dataroot(),
                   {{"--scenes scene-9999", "scene-9999"}, {"--json same --csv same", "differ"}});
    EXPECT_EQ(runTool(tool, "--bad").exit_code, 2);
  }
}

TEST_F(Evaluators, ABackendIsCheckedBeforeAnythingIsRead) {
  for (const auto& [tool, options] : {std::pair("evaluate_depth", "--depth-backend telepathy"),
                                      {"evaluate_flow", "--flow-backend telepathy"},
                                      {"evaluate_segmentation", "--flow-backend telepathy"},
                                      {"evaluate_objects", "--saved-masks m --depth-backend telepathy"}})
    expectRefusals(tool, "--dataroot /nowhere", {{options, "telepathy"}});
}

TEST_F(Evaluators, ReportsRepeatTheirRuns) {
  test::expectReportRepeatsRun(
      commandOf("evaluate_ego_velocity", ""),
      dataroot() +
          " --scenes scene-0002 --doppler-scale 1.0021 --model ackermann --no-filter "
          "--mount-yaw-correction RADAR_FRONT=0.0123 --invalid-states '' --max-rcs 30");
  test::expectReportRepeatsRun(
      commandOf("evaluate_objects", ""),
      dataroot() + " --isolated-speed 0.83 --object-returns all --weak-threshold inf");
  test::expectReportRepeatsRun(
      commandOf("evaluate_segmentation", ""),
      dataroot() +
          " --scenes scene-0001 --max-pairs 2 --working-width 160 --best --memory 0.3 --no-refine-ground "
          "--depth-std 0.21");
}

TEST_F(Evaluators, TheBestIsWhatIsNotSetOtherwise) {
  const Outcome outcome =
      runTool("evaluate_segmentation", dataroot() +
                                           " --scenes scene-0001 --max-pairs 2 --working-width 160 --best "
                                           "--memory 0 --no-refine-ground" +
                                           files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const rapidjson::Document document = report();
  const rapidjson::Value& parameters = document["parameters"]["dynamic_segmentation"];
  EXPECT_EQ(parameters["memory"].GetDouble(), 0.0);
  EXPECT_FALSE(parameters["refine_ground"].GetBool());
  EXPECT_EQ(parameters["border"].GetInt(), 40);
  EXPECT_TRUE(parameters["look_back"].GetBool());
}

using EvaluateEgoVelocity = Evaluators;

TEST_F(EvaluateEgoVelocity, WritesTableJsonAndCsv) {
  const Outcome outcome =
      runTool("evaluate_ego_velocity", dataroot() + " --scenes scene-0001,scene-0002" + files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const rapidjson::Document document = report();
  EXPECT_STREQ(document["parameters"]["tool"].GetString(), "evaluate_ego_velocity");
  EXPECT_STREQ(document["scenes"][1]["scene"].GetString(), "scene-0002");
  const rapidjson::Value& overall = document["overall"];
  const unsigned pairs = test::FixtureOptions().samples_per_scene - 1;
  EXPECT_EQ(overall["frames"].GetUint(), 2 * pairs);
  EXPECT_EQ(overall["refused"].GetUint(), 0U);
  EXPECT_LT(overall["models"]["planar_yaw"]["vx_mae"].GetDouble(), 0.01) << "the fixture's radar is exact";
  expectCsv({"scene,frames,refused,B1,", fmt::format("scene-0001,{},0,", pairs),
             fmt::format("scene-0002,{},0,", pairs), fmt::format("overall,{},0,", 2 * pairs)});
  const auto written = fs::directory_iterator(folder_.path());
  EXPECT_EQ(std::distance(begin(written), end(written)), 2) << "a temporary file is left";
}

TEST_F(EvaluateEgoVelocity, TheFilterHasATableOfItsOwn) {
  const std::string title = "filtered over the sweeps";
  for (const auto& [options, is_there] :
       {std::pair(" --mount-yaw-std 0.01", true), {" --no-filter-radars", true}, {" --no-filter", false}}) {
    const std::string text = runTool("evaluate_ego_velocity", dataroot() + options).text;
    EXPECT_EQ(text.find(title) != std::string::npos, is_there) << options;
  }
}

TEST_F(EvaluateEgoVelocity, BadOptionsGetOneLine) {
  expectRefusals("evaluate_ego_velocity", dataroot(),
                 {{"--radar-channels RADAR_ROOF", "RADAR_ROOF"},
                  {"--model bicycle", "planar_yaw"},
                  {"--threshold -1", "--threshold"},
                  {"--ransac-iterations 0", "--ransac-iterations"},
                  {"--doppler-scale 0", "--doppler-scale"},
                  {"--no-such-option", "--no-such-option"},
                  {"--longitudinal-jerk 0", "--longitudinal-jerk"},
                  {"--bearing-delay 5", "--bearing-delay"},
                  {"--mount-yaw-correction RADAR_FRONT", "CHANNEL=RAD"},
                  {"--mount-yaw-correction RADAR_FRONT=nan", "RADAR_FRONT"},
                  {"--mount-yaw-correction RADAR_TYPO=0.1", "RADAR_TYPO"},
                  {"--saved-masks /nowhere", "/nowhere"},
                  {"--saved-masks /nowhere --mask-channel CAM_ROOF", "CAM_ROOF"},
                  {"--mask-max-age -1", "--mask-max-age"}});
  expectRefusals("evaluate_ego_velocity", "--dataroot " + fixture_->dataroot().string(),
                 {{"--version v9.9", "v9.9"}});
  const Outcome outcome = runTool("evaluate_ego_velocity", dataroot() + " --json /nowhere/out.json");
  EXPECT_NE(outcome.exit_code, 0);
  expectParts(outcome.text, {"evaluate_ego_velocity: /nowhere/out.json"});
}

TEST_F(EvaluateEgoVelocity, LinksAndPipesSurvive) {
  const fs::path real = folder_.path() / "real.json";
  test::writeFile(real, "old");
  fs::create_symlink(real, folder_.path() / "link.json");
  const std::string command = commandOf("evaluate_ego_velocity", dataroot()) + " --json ";
  ASSERT_EQ(test::runCommand(command + (folder_.path() / "link.json").string()).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_.path() / "link.json"));
  EXPECT_EQ(test::readFile(real).front(), '{');

  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Outcome outcome = test::runCommand(command + pipe.string() + " >/dev/null & cat " + pipe.string());
  EXPECT_EQ(outcome.text.front(), '{');
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(EvaluateEgoVelocity, MissingFilesAreCounted) {
  test::FixtureOptions options;
  options.channels_on_disk = {"RADAR_FRONT", "RADAR_BACK_LEFT"};
  const test::NuscenesFixture partial(options);
  const std::string root = "--dataroot " + partial.dataroot().string();
  const Outcome outcome = runTool("evaluate_ego_velocity", root + " --json " + json());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  expectParts(outcome.text, {"Left out:\n  scene-0001 (radar files): not on disk: RADAR_BACK_RIGHT "});
  const std::string why = report()["left_out"]["scene-0002 (radar files)"].GetString();
  expectParts(why, {"RADAR_FRONT_LEFT "});
  EXPECT_EQ(why.find("RADAR_FRONT "), std::string::npos) << why;
  expectRefusals("evaluate_ego_velocity", root,
                 {{"--scenes scene-0001 --radar-channels RADAR_FRONT,RADAR_FRONT_LEFT", "RADAR_FRONT_LEFT"}});
}

/// A tool, the options of a quick run, and a file of scene-0001 that it reads.
struct BrokenInput {
  const char* tool;
  const char* options;
  const char* channel;
};

// What is left is as if the other scene had been asked for alone.
TEST_F(Evaluators, ABrokenFileCostsItsSceneAlone) {
  for (const BrokenInput& input :
       {BrokenInput{"evaluate_ego_velocity", "", "RADAR_FRONT"},
        {"evaluate_objects", "", "RADAR_FRONT"},
        {"evaluate_segmentation", " --working-width 160 --max-pairs 2", "CAM_FRONT"},
        {"evaluate_segmentation", " --working-width 160 --max-pairs 2 --jobs 2", "RADAR_FRONT"},
        {"calibrate_radars", "", "RADAR_FRONT"}}) {
    SCOPED_TRACE(std::string(input.tool) + input.options + " " + input.channel);
    const test::NuscenesFixture fixture;
    const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
    const fs::path broken = tables.path(at(tables.sample_data, tables.readingsOf(0, input.channel)[1]));
    const bool is_image = std::string(input.channel) == "CAM_FRONT";
    // Half a JPEG can be decoded.
    is_image ? fs::resize_file(broken, fs::file_size(broken) / 2) : test::writeFile(broken, "404 Not Found");
    const std::string root = "--version v1.0-mini --dataroot " + fixture.dataroot().string() + input.options;
    const Outcome alone = runTool(input.tool, root + " --scenes scene-0002" + files());
    ASSERT_EQ(alone.exit_code, 0) << alone.text;
    EXPECT_EQ(report()["left_out"].MemberCount(), 0U);
    const std::string figures = test::readFile(csv());
    const Outcome outcome = runTool(input.tool, root + files());
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    expectParts(outcome.text, {"\nLeft out:\n  scene-0001: ", broken.string(), "done in part"});
    ASSERT_EQ(report()["left_out"].MemberCount(), 1U);
    expectParts(report()["left_out"]["scene-0001"].GetString(), {broken.string()});
    const bool has_times = std::string(input.tool) == "evaluate_segmentation";
    EXPECT_TRUE(has_times || test::readFile(csv()) == figures);
    // With both scenes broken there is no result.
    test::writeFile(tables.path(at(tables.sample_data, tables.readingsOf(1, input.channel)[1])), "");
    const Outcome nothing = runTool(input.tool, root);
    EXPECT_EQ(nothing.exit_code, 1);
    expectParts(nothing.text, {"scene-0001: ", "none of the 2 scenes can be used"});
  }
}

TEST_F(Evaluators, ImagesOfAnotherSizeAreNotCompared) {
  const test::NuscenesFixture fixture;
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  const fs::path small = tables.path(at(tables.sample_data, tables.readingsOf(1, "CAM_FRONT")[1]));
  test::writeImage(small, cv::Mat(450, 800, CV_8UC1, cv::Scalar(100)));
  const Outcome outcome = runTool("evaluate_segmentation", "--working-width 160 --max-pairs 2 --dataroot " +
                                                               fixture.dataroot().string() + files());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  expectParts(report()["left_out"]["scene-0002"].GetString(),
              {small.string(), "has 800x450 px, not the 1600x900 of sample_data.json"});
}

// The fixture annotates CAM_FRONT; the tables list readings of the other sensor all the same.
TEST_F(Evaluators, ACameraWithoutTruthIsNotScored) {
  expectRefusals("evaluate_segmentation", dataroot(),
                 {{"--camera RADAR_FRONT", "has no mask of RADAR_FRONT, only of CAM_FRONT"}});
}

TEST_F(Evaluators, MergedReportsTellWhatWasLeftOutOfThem) {
  evaluation::SegmentationReport scene;
  scene.scene = "scene-0002";
  const fs::path one = folder_.path() / "one.json", two = folder_.path() / "two.json";
  test::writeFile(
      one, "{\"left_out\": {\"scene-0002\": \"was broken\", \"scene-0003\": \"is broken\"}, \"scenes\": []}");
  test::writeFile(two, evaluation::formatJson(std::vector{scene}, scene));
  const Outcome merged =
      runTool("evaluate_segmentation", fmt::format("--merge {},{}", one.string(), two.string()) + files());
  EXPECT_EQ(merged.exit_code, 3) << merged.text;
  expectParts(merged.text, {"Left out:\n  scene-0003: is broken\n"});
  EXPECT_EQ(report()["left_out"].MemberCount(), 1U) << "a later run has scene-0002";
}

// No file of the dataroot is read: it is not there.
TEST_F(Evaluators, OutputsThatCannotBeWrittenAreFoundBeforeTheWork) {
  const std::string file = folder_.path() / "file";
  test::writeFile(file, "");
  for (const std::string tool :
       {"evaluate_depth", "evaluate_flow", "evaluate_objects", "evaluate_segmentation", "calibrate_radars"})
    expectRefusals(tool, "--dataroot /missing", {{"--csv /nowhere/out", "/nowhere/out: cannot be written"}});
  for (const std::string& target : {folder_.path().string(), file + "/out"})
    expectRefusals("evaluate_ego_velocity", "--dataroot /missing",
                   {{"--json " + target, target + ": cannot be written"}});
  expectRefusals("evaluate_ego_velocity", "--dataroot /missing", {{"--json " + json(), "/missing"}});
  expectRefusals("evaluate_segmentation", "--dataroot /missing",
                 {{"--save-masks /proc/masks", "/proc/masks"}});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1)
      << "the trials are gone";
}

// The device takes no byte, and the reader of the table has gone.
TEST_F(Evaluators, NothingThatCannotBeWrittenKeepsTheRest) {
  const Outcome full = runTool("evaluate_ego_velocity", dataroot() + " --json /dev/full --csv " + csv());
  EXPECT_EQ(full.exit_code, 1);
  expectParts(full.text, {"\noverall ", "/dev/full: cannot be written"});
  expectCsv({"scene,", "scene-0001,", "scene-0002,", "overall,"});
  test::runCommand("{ sleep 0.1; " + commandOf("evaluate_ego_velocity", dataroot()) + files() + "; } | true");
  EXPECT_EQ(report()["scenes"].Size(), 2U);
}

TEST_F(EvaluateEgoVelocity, ATruncatedPcdIsNamed) {
  const test::NuscenesFixture broken;
  for (const auto& entry : fs::directory_iterator(broken.dataroot() / "samples" / "RADAR_FRONT"))
    fs::resize_file(entry.path(), 700);
  const Outcome outcome = runTool("evaluate_ego_velocity", "--dataroot " + broken.dataroot().string());
  EXPECT_NE(outcome.exit_code, 0);
  expectParts(outcome.text, {"RADAR_FRONT", "record"});
}

TEST_F(Evaluators, ObjectsAreWrittenToTableJsonAndCsv) {
  const Outcome outcome = runTool("evaluate_objects", dataroot() + files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  expectParts(outcome.text, {"Precision %", "scene-0001", "scene-0002", "Overall", "vehicle"});
  EXPECT_EQ(report()["overall"]["keyframes"].GetUint(), 2 * test::FixtureOptions().samples_per_scene);
  expectCsv({"scene,precision,", "scene-0001,", "scene-0002,", "overall,"});
  expectRefusals("evaluate_objects", dataroot(),
                 {{"--radar-channels RADAR_ROOF", "RADAR_ROOF"},
                  {"--saved-masks /nowhere/masks", "/nowhere/masks"},
                  {"--saved-masks /nowhere/masks --mask-delay 0.5", "max-lag"}});
}

// The fixture has a lidar sweep for the first of its images.
TEST_F(Evaluators, DepthIsWrittenToTableJsonAndCsv) {
  const Outcome outcome =
      runTool("evaluate_depth", dataroot() + " --truth lidar --working-width 400" + files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  expectParts(outcome.text, {"scene-0001          1         3", "scene-0002          0         4",
                             "Overall             1         7"});
  EXPECT_EQ(report()["overall"]["without_truth"].GetUint(), 7U);
  expectCsv({"scene,mae_50,", "scene-0001,", "scene-0002,,", "overall,"});
  expectRefusals("evaluate_depth", dataroot(),
                 {{"--max-images -1", "--max-images"},
                  {"--truth radar", "--truth is 'radar'"},
                  {"--truth lidar --scenes scene-0002", "LIDAR_TOP"}});
  const Outcome refused = runTool("evaluate_depth", dataroot() + " --truth ground_truth");
  EXPECT_EQ(refused.exit_code, 1);
  expectParts(refused.text, {"evaluate_depth: scene-0001: " + fixture_->dataroot().string() +
                             "/ground_truth/depth: is not there"});
}

TEST_F(Evaluators, FlowIsWrittenToTableJsonAndCsv) {
  expectRefusals("evaluate_flow", dataroot(),
                 {{"", "ground_truth/keyframe_flow: is not there"},
                  {"--pairs triplets", "--pairs is 'triplets'"},
                  {"--first a.png --second b.png --flow-truth c.png", "--dataroot"}});
  test::FixtureOptions few;
  few.samples_per_scene = 2;
  const test::NuscenesFixture fixture(few);
  test::FixtureFlow::write(fixture);
  const Outcome outcome = runTool("evaluate_flow",
                                  "--version v1.0-mini --preset ultrafast --working-width 160 "
                                  "--dataroot " +
                                      fixture.dataroot().string() + files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  expectParts(outcome.text, {"px of the full image", "scene-0001          1", "scene-0002          1",
                             "Overall             2"});
  EXPECT_EQ(report()["overall"]["pairs"].GetUint(), 2U);
  expectCsv({"scene,epe_all,", "scene-0001,", "scene-0002,", "overall,"});
}

/// Two equal images of noise, in which DIS finds no motion.
TEST_F(Evaluators, FlowOfASinglePair) {
  cv::Mat noise(90, 160, CV_8UC1);
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 256);
  for (const char* name : {"one.png", "two.png"}) test::writeImage(folder_.path() / name, noise);
  test::writeFlow(folder_.path() / "flow.png", cv::Mat(90, 160, CV_32FC2, cv::Scalar(3.0, 4.0)));
  const std::string pair = fmt::format("--first {0}/one.png --second {0}/two.png --flow-truth {0}/flow.png",
                                       folder_.path().string());
  for (const char* options : {"", " --working-width 80", " --preset fine --forward-backward"}) {
    SCOPED_TRACE(options);
    const Outcome outcome = runTool("evaluate_flow", pair + options + " --json " + json());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
    expectParts(outcome.text, {"one                 1      5.000"});
    EXPECT_EQ(report()["overall"]["fl_all"].GetDouble(), 1.0);
  }
  expectRefusals(
      "evaluate_flow", "",
      {{"--first a.png", "--second"},
       {"--first a.png --second b.png", "--flow-truth"},
       {"--first a.png --second b.png --flow-truth c.png", "a.png: is not there"},
       {"--first a.png --second b.png --flow-truth c.png --pairs next", "--pairs"},
       {"--first a.png --second b.png --flow-truth c.png --initialisation temporal", "single pair"}});
  expectRefusals("evaluate_flow", pair,
                 {{"--flow-backend telepathy", "telepathy"},
                  {"--preset best", "--preset is 'best'"},
                  {"--working-width 20", "too small"}});
}

TEST_F(Evaluators, SegmentationComparesTheLoopAndMergesComparisons) {
  const std::string masks = (folder_.path() / "masks").string();
  const Outcome outcome = runTool(
      "evaluate_segmentation",
      dataroot() + " --scenes scene-0001 --max-pairs 2 --working-width 160 --compare-loop --save-masks " +
          masks + " --json " + json());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  expectParts(outcome.text, {"neither ", "mask_to_velocity ", "radar_to_mask ", "both "});
  EXPECT_EQ(report()["loop"].Size(), 4U);
  const auto saved = fs::directory_iterator(masks);
  EXPECT_EQ(std::distance(begin(saved), end(saved)), 2);
  const Outcome merged = runTool("evaluate_segmentation", "--merge " + json());
  EXPECT_EQ(merged.exit_code, 0) << merged.text;
  expectParts(outcome.text, {merged.text});  // the progress of the run is in its text, too
  expectRefusals("evaluate_segmentation", dataroot(),
                 {{"--jobs 0", "--jobs"},
                  {"--mask-max-age -1", "--mask-max-age"},
                  {"--mask-to-velocity --velocity ground_truth", "--mask-to-velocity"},
                  {"--compare-loop --velocity ground_truth", "--compare-loop"}});
  expectRefusals("evaluate_segmentation", "", {{"--merge /nowhere.json", "/nowhere.json"}});
}

// The masks of each step are in a folder of their own.
TEST_F(Evaluators, SegmentationSavesTheMasksOfEveryStep) {
  const fs::path masks = folder_.path() / "masks";
  const Outcome outcome =
      runTool("evaluate_segmentation", dataroot() +
                                           " --scenes scene-0001 --max-pairs 1 --working-width 160 --jobs 2 "
                                           "--ablation --save-masks " +
                                           masks.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* step :
       {"paper", "uncertainty", "refinement", "radar_evidence", "image_borders", "look_back", "memory"})
    EXPECT_FALSE(fs::is_empty(masks / step)) << step;
}

// The paper's score and the defaults, on real images, with whatever flow is at hand.
TEST_F(Evaluators, SegmentationFindsRealMovers) {
  const std::string real = std::string(RADAR_DOT_SHARED_DATA) + "/nuscenes_mini_real";
  if (!fs::exists(real)) GTEST_SKIP() << real << " is not there";
  const Outcome outcome =
      runTool("evaluate_segmentation", "--scenes scene-0103 --max-pairs 6 --dataroot " + real + files());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_GT(report()["overall"]["true_positives"].GetUint(), 0U);
}

}  // namespace
}  // namespace radar_dot
