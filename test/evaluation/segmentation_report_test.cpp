// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fixtures/refusal.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot::evaluation {
namespace {

SegmentationReport report(const std::string& scene, std::size_t tp, std::size_t fp, std::size_t fn,
                          std::size_t tn) {
  SegmentationReport result;
  result.scene = scene;
  result.frames = 3;
  result.pixels = {tp, fp, fn, tn};
  result.seconds = 0.25;
  result.velocity_error = {0.75, 3};
  return result;
}

class SegmentationFiles : public ::testing::Test {
 protected:
  SegmentationFiles() { std::filesystem::create_directories(folder_); }
  ~SegmentationFiles() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file) << text;
    return file.string();
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / "radar_dot_segmentation_report";
};

TEST(SegmentationReport, FiguresByHand) {
  const SegmentationReport result = report("a", 30, 10, 20, 940);
  EXPECT_DOUBLE_EQ(result.iou(), 0.5);
  EXPECT_DOUBLE_EQ(result.pixels.precision(), 0.75);
  EXPECT_DOUBLE_EQ(result.pixels.recall(), 0.6);
  EXPECT_DOUBLE_EQ(result.pixels.f1(), 2.0 * 0.75 * 0.6 / 1.35);
  EXPECT_DOUBLE_EQ(result.falsePositiveShare(), 10.0 / 950.0);
  EXPECT_TRUE(std::isnan(report("a", 0, 0, 0, 9).iou()));
  EXPECT_DOUBLE_EQ(result.velocity_error.value(), 0.25);
  EXPECT_TRUE(std::isnan(SegmentationReport().velocity_error.value()));
}

// A large scene and a small one: the mean of 0.9 and 0.1 would be 0.5.
TEST(SegmentationReport, PixelsAreSummedNotAveraged) {
  SegmentationReport overall = report("large", 900, 50, 50, 0);
  overall += report("small", 1, 4, 5, 0);
  EXPECT_EQ(overall.frames, 6U);
  EXPECT_EQ(overall.velocity_error.count, 6U);
  EXPECT_DOUBLE_EQ(overall.velocity_error.sum, 1.5);
  EXPECT_DOUBLE_EQ(overall.iou(), 901.0 / 1010.0);
}

TEST_F(SegmentationFiles, MergedFilesGiveTheSameTable) {
  const SegmentationReport a = report("scene-0002", 5, 6, 7, 8);
  const SegmentationReport b = report("scene-0001", 0, 0, 0, 80);
  const std::string first = write("a.json", formatJson({a}, a));
  const std::string second = write("b.json", formatJson({b}, b));
  EXPECT_NE(formatJson({b}, b).find("\"iou\": null"), std::string::npos);
  const std::vector<SegmentationReport> merged = mergeJson({first, second});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[0].scene, "scene-0001");
  SegmentationReport overall = a;
  overall += b;
  EXPECT_EQ(formatTable(merged, overall), formatTable({b, a}, overall));
  EXPECT_EQ(formatCsv(merged, overall), formatCsv({b, a}, overall));
}

TEST_F(SegmentationFiles, VelocityErrorsStandInTableAndFiles) {
  SegmentationReport true_velocity = report("scene-0001", 1, 1, 1, 1);
  true_velocity.velocity_error = {};
  const SegmentationReport by_radar = report("scene-0002", 1, 1, 1, 1);
  SegmentationReport overall = true_velocity;
  overall += by_radar;
  const std::vector<SegmentationReport> scenes = {true_velocity, by_radar};
  const std::string json = formatJson(scenes, overall);
  EXPECT_NE(json.find("\"velocity_error\": null"), std::string::npos) << json;
  EXPECT_NE(json.find("\"velocity_error\": 0.25"), std::string::npos) << json;
  const std::string csv = formatCsv(scenes, overall);
  EXPECT_NE(csv.find(",velocity_error,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("scene-0002,0.333333,0.500000,0.500000,0.500000,0.500000,0.250000,3,"),
            std::string::npos)
      << csv;
  const std::string table = formatTable(scenes, overall);
  EXPECT_NE(table.find("v err m/s"), std::string::npos) << table;
  EXPECT_NE(table.find("     0.2500"), std::string::npos) << table;
}

TEST_F(SegmentationFiles, EveryCountComesBack) {
  SegmentationReport one = report("scene-0001", 11, 12, 13, 14);
  one.without_motion = 2;
  one.seconds = 0.1;  // no finite binary fraction: only the shortest decimal brings it back
  SegmentationReport two = report("scene-0002", 21, 22, 23, std::size_t{1} << 53U);
  SegmentationReport overall = one;
  overall += two;
  const std::vector<SegmentationReport> read =
      mergeJson({write("two.json", formatJson({one, two}, overall))});
  ASSERT_EQ(read.size(), 2U);
  for (const auto& [got, wanted] : {std::pair{read[0], one}, std::pair{read[1], two}}) {
    EXPECT_EQ(got.scene, wanted.scene);
    EXPECT_EQ(got.frames, wanted.frames);
    EXPECT_EQ(got.without_motion, wanted.without_motion);
    EXPECT_EQ(got.pixels.true_positives, wanted.pixels.true_positives);
    EXPECT_EQ(got.pixels.false_positives, wanted.pixels.false_positives);
    EXPECT_EQ(got.pixels.false_negatives, wanted.pixels.false_negatives);
    EXPECT_EQ(got.pixels.true_negatives, wanted.pixels.true_negatives);
    EXPECT_DOUBLE_EQ(got.seconds, wanted.seconds);
    EXPECT_EQ(got.velocity_error.count, wanted.velocity_error.count);
    EXPECT_DOUBLE_EQ(got.velocity_error.sum, wanted.velocity_error.sum);
  }
}

TEST_F(SegmentationFiles, EveryFieldIsCheckedByName) {
  const SegmentationReport a = report("scene-0001", 1, 1, 1, 1);
  const std::string text = formatJson({a}, a);
  for (const std::string field :
       {"scene", "frames", "without_motion", "true_positives", "false_positives", "false_negatives",
        "true_negatives", "seconds", "velocity_error_sum", "velocity_error_count"}) {
    std::string broken = text;
    broken.replace(broken.find("\"" + field + "\":") + 1, field.size(), "other");
    const std::string file = write(field + ".json", broken);
    try {
      mergeJson({file});
      ADD_FAILURE() << field;
    } catch (const std::runtime_error& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find(file), 0U) << message;
      EXPECT_NE(message.find("'" + field + "'"), std::string::npos) << message;
    }
  }
}

TEST_F(SegmentationFiles, WrongFilesAreNamed) {
  const SegmentationReport a = report("scene-0001", 1, 1, 1, 1);
  const std::string good = write("good.json", formatJson({a}, a));
  const auto expect = [](const std::vector<std::string>& files, const std::string& part) {
    test::expectRefusal<std::runtime_error>([&files] { mergeJson(files); }, {part});
  };
  expect({good, good}, "scene-0001 also stands in");
  expect({"/nowhere.json"}, "/nowhere.json: cannot be opened");
  expect({write("cut.json", "{\"scenes\": [")}, "cut.json: byte");
  expect({write("other.json", "{}")}, "has no list 'scenes'");
  expect({write("tail.json", formatJson({a}, a) + "x")}, "tail.json: byte");
  expect({write("deep.json", std::string(1000000, '['))}, "deep.json: byte");
  SegmentationReport impossible = a;
  impossible.without_motion = impossible.frames + 1;
  expect({write("more.json", formatJson({impossible}, a))}, "field 'without_motion'");
  impossible = a;
  impossible.velocity_error.count = impossible.frames + 1;
  expect({write("pairs.json", formatJson({impossible}, a))}, "field 'velocity_error_count'");
  impossible = a;
  impossible.seconds = -1.0;
  expect({write("negative.json", formatJson({impossible}, a))}, "field 'seconds'");
  expect({write("field.json", "{\"scenes\": [{\"scene\": \"a\", \"frames\": -1}]}")}, "field 'frames'");
}

}  // namespace
}  // namespace radar_dot::evaluation
