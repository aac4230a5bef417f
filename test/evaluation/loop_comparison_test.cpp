// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/loop_comparison.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

SegmentationReport report(const std::string& scene, std::size_t tp, std::size_t fp) {
  SegmentationReport result;
  result.scene = scene;
  result.frames = 4;
  result.pixels = {tp, fp, 10, 100};
  result.velocity_error = {0.5, 2};
  return result;
}

std::vector<LoopResult> results(const SegmentationReport& overall) {
  std::vector<LoopResult> all;
  for (const bool radar_to_mask : {false, true})
    for (const bool mask_to_velocity : {false, true})
      all.push_back({mask_to_velocity, radar_to_mask, overall});
  return all;
}

TEST(LoopComparison, VariantsAreTheFourCombinations) {
  SegmentationEvaluationOptions options;
  options.mask_directory = "masks";
  options.pairs.camera = "CAM_BACK";
  options.segmentation.motion.radar.dynamic_gain = 0.0;  // the variants with it take the default
  const std::vector<SegmentationEvaluationOptions> variants = loopVariants(options);
  ASSERT_EQ(variants.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(variants[i].mask_to_velocity, i % 2 == 1);
    EXPECT_EQ(variants[i].segmentation.motion.radar.dynamic_gain,
              i >= 2 ? MotionParams{}.radar.dynamic_gain : 0.0);
    EXPECT_EQ(variants[i].pairs.camera, "CAM_BACK");
    EXPECT_EQ(variants[i].mask_directory, i == 0 ? "masks" : "");
  }
}

TEST(LoopComparison, TheOptionsThemselvesAreOneOfThem) {
  SegmentationEvaluationOptions options;
  options.mask_directory = "masks";
  options.segmentation.motion.radar.dynamic_gain = 2.5;
  for (const bool mask_to_velocity : {false, true}) {
    options.mask_to_velocity = mask_to_velocity;
    const std::vector<SegmentationEvaluationOptions> variants = loopVariants(options);
    const SegmentationEvaluationOptions& own = variants.at(ownVariant(options));
    EXPECT_EQ(own.mask_to_velocity, mask_to_velocity);
    EXPECT_EQ(own.segmentation.motion.radar.dynamic_gain, 2.5);
    EXPECT_EQ(own.mask_directory, "masks");
    EXPECT_EQ(variants[0].segmentation.motion.radar.dynamic_gain, 0.0);
    EXPECT_TRUE(variants[0].mask_directory.empty());
  }
}

TEST(LoopComparison, TheTableHasALineForEach) {
  const std::string table = formatLoopTable(results(report("", 30, 60)));
  EXPECT_NE(table.find("v err m/s\nneither                 4     0.3000     0.3333     0.7500     0.4615     "
                       "0.2500\nmask_to_velocity "),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\nradar_to_mask "), std::string::npos) << table;
  EXPECT_NE(table.find("\nboth "), std::string::npos) << table;
}

TEST(LoopComparison, MergedFilesSumUp) {
  const test::TemporaryFolder folder;
  const auto write = [&folder](const char* name, const std::string& text) {
    test::writeFile(folder.path() / name, text);
    return (folder.path() / name).string();
  };
  const SegmentationReport a = report("scene-0001", 3, 4), b = report("scene-0002", 7, 11);
  const std::string first = write("a.json", formatJson({a}, a, results(a)));
  const std::string second = write("b.json", formatJson({b}, b, results(b)));
  const std::string plain = write("c.json", formatJson({a}, a));
  EXPECT_EQ(mergeJson({first, second}).size(), 2U);  // the scenes are there as without the comparison
  const std::vector<LoopResult> merged = mergeLoop({first, second});
  ASSERT_EQ(merged.size(), 4U);
  EXPECT_TRUE(merged[1].mask_to_velocity);
  EXPECT_FALSE(merged[1].radar_to_mask);
  EXPECT_EQ(merged[1].overall.pixels.true_positives, 10U);
  EXPECT_EQ(merged[3].overall.pixels.false_positives, 15U);
  EXPECT_EQ(merged[3].overall.velocity_error.count, 4U);
  EXPECT_DOUBLE_EQ(merged[3].overall.velocity_error.sum, 1.0);
  EXPECT_TRUE(mergeLoop({plain}).empty());
  test::expectRefusal<std::runtime_error>([&] { mergeLoop({first, plain}); }, {plain, "'loop'", first});
}

TEST(LoopComparison, BrokenFieldsAreNamed) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "loop.json").string();
  const SegmentationReport a = report("scene-0001", 3, 4);
  const std::string text = formatJson({a}, a, results(a));
  const std::size_t loop = text.find("\"loop\":");
  for (const std::string field : {"mask_to_velocity", "radar_to_mask", "overall", "velocity_error_sum"}) {
    std::string broken = text;
    broken.replace(broken.find("\"" + field + "\":", loop) + 1, field.size(), "other");
    test::writeFile(file, broken);
    test::expectRefusal<std::runtime_error>([&file] { mergeLoop({file}); },
                                            {file + ": loop 0", "'" + field + "'"});
  }
}

}  // namespace
}  // namespace radar_dot::evaluation
