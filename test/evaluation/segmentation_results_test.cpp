// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/segmentation_results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation/merged_reports.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

SegmentationReport report(const std::string& scene, std::size_t tp, std::size_t fp, std::size_t fn,
                          std::size_t tn) {
  SegmentationReport result;
  result.scene = scene;
  result.frames = 3;
  result.addPair({tp, fp, fn, tn});
  result.seconds = 0.24;
  result.velocity_error = {0.75, 3};
  return result;
}

std::vector<SegmentationReport> mergedOf(const std::vector<std::string>& files) {
  return scenesOf<SegmentationReport>(readReports("evaluate_segmentation", files));
}

SegmentationReport sumOf(const std::vector<SegmentationReport>& scenes) {
  SegmentationReport sum;
  for (const SegmentationReport& scene : scenes) sum += scene;
  return sum;
}

/// A comparison whose variants are all alike.
Comparison comparison(Variants variants, const std::vector<SegmentationReport>& scenes) {
  Comparison result = comparisonOf(variants, {});
  for (VariantResult& variant : result.results) {
    variant.scenes = scenes;
    variant.overall = sumOf(scenes);
  }
  return result;
}

class SegmentationFiles : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    test::writeFile(folder_.path() / name, text);
    return (folder_.path() / name).string();
  }
  std::string write(const std::string& name, Variants variants,
                    const std::vector<SegmentationReport>& scenes) const {
    return write(name, formatJson(scenes, sumOf(scenes), comparison(variants, scenes)));
  }
  test::TemporaryFolder folder_;
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

// Of two pairs, one found and one not: the standard error of the mean of 0 and 1.
TEST(SegmentationReport, ErrorOfTheIntersectionOverUnionByHand) {
  const auto of = [](const std::vector<Confusion>& pairs) {
    SegmentationReport result;
    result.frames = pairs.size();
    for (const Confusion& pair : pairs) result.addPair(pair);
    return result;
  };
  const SegmentationReport uneven = of({{0, 4, 6, 90}, {10, 0, 0, 90}});
  EXPECT_DOUBLE_EQ(uneven.iou(), 0.5);
  EXPECT_NEAR(uneven.iouError(), 0.5, 1e-12);
  EXPECT_NEAR(of({{1, 1, 0, 0}, {20, 0, 20, 0}, {300, 200, 100, 0}}).iouError(), 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(of({{1, 1, 0, 0}}).iouError()));
  SegmentationReport twice = uneven;
  twice += uneven;  // as of two files
  EXPECT_NEAR(twice.iouError(), std::sqrt(100.0 * 4 / 3) / 40, 1e-12);
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
  const std::string first = write("a.json", formatJson(std::vector{a}, a));
  const std::string second = write("b.json", formatJson(std::vector{b}, b));
  EXPECT_NE(formatJson(std::vector{b}, b).find("\"iou\": null"), std::string::npos);
  const std::vector<SegmentationReport> merged = mergedOf({first, second});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[0].scene, "scene-0002") << "in the order of the files";
  SegmentationReport overall = a;
  overall += b;
  EXPECT_EQ(formatTable(merged, overall), formatTable({a, b}, overall));
  EXPECT_EQ(formatCsv(merged, overall), formatCsv({a, b}, overall));
}

TEST_F(SegmentationFiles, WrongFilesAreNamed) {
  const SegmentationReport a = report("scene-0001", 1, 1, 1, 1);
  const std::string good = write("good.json", formatJson(std::vector{a}, a));
  const auto expect = [](const std::vector<std::string>& files, const std::string& part) {
    test::expectRefusal<std::runtime_error>([&files] { mergedOf(files); }, {part});
  };
  expect({good, good}, "scene-0001 also stands in");
  expect({"/nowhere.json"}, "/nowhere.json: cannot be opened");
  expect({write("cut.json", "{\"scenes\": [")}, "cut.json: byte");
  expect({write("other.json", "{}")}, "has no list 'scenes'");
  expect({write("tail.json", formatJson(std::vector{a}, a) + "x")}, "tail.json: byte");
  expect({write("deep.json", std::string(1000000, '['))}, "deep.json: byte");
  expect({write("old.json", "{\"scenes\": [{\"scene\": \"a\"}]}")}, "field 'sums'");
  expect({write("sums.json", "{\"scenes\": [{\"scene\": \"a\", \"sums\": \"1 2\"}]}")},
         "scene 0: field 'sums'");
}

TEST(LoopComparison, VariantsAreTheFourCombinations) {
  SegmentationEvaluationOptions options;
  options.mask_directory = "masks";
  options.pairs.camera = "CAM_BACK";
  options.segmentation.motion.radar.dynamic_gain = 0.0;  // the variants with it take the default
  const std::vector<VariantResult> variants = comparisonOf(Variants::kLoop, options).results;
  ASSERT_EQ(variants.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(variants[i].options.mask_to_velocity, i % 2 == 1);
    EXPECT_EQ(variants[i].options.segmentation.motion.radar.dynamic_gain,
              i >= 2 ? MotionParams{}.radar.dynamic_gain : 0.0);
    EXPECT_EQ(variants[i].options.pairs.camera, "CAM_BACK");
    EXPECT_EQ(variants[i].options.mask_directory, i == 0 ? "masks" : "");
  }
}

TEST(LoopComparison, TheOptionsThemselvesAreOneOfThem) {
  SegmentationEvaluationOptions options;
  options.mask_directory = "masks";
  options.segmentation.motion.radar.dynamic_gain = 2.5;
  for (const bool mask_to_velocity : {false, true}) {
    options.mask_to_velocity = mask_to_velocity;
    const std::vector<VariantResult> variants = comparisonOf(Variants::kLoop, options).results;
    const SegmentationEvaluationOptions& own =
        variants.at(ownVariant(comparisonOf(Variants::kLoop, options), options)).options;
    EXPECT_EQ(own.mask_to_velocity, mask_to_velocity);
    EXPECT_EQ(own.segmentation.motion.radar.dynamic_gain, 2.5);
    EXPECT_EQ(own.mask_directory, "masks");
    EXPECT_EQ(variants[0].options.segmentation.motion.radar.dynamic_gain, 0.0);
    EXPECT_TRUE(variants[0].options.mask_directory.empty());
  }
}

std::vector<VariantResult> stepsOf(const SegmentationEvaluationOptions& options) {
  return comparisonOf(Variants::kAblation, options).results;
}

TEST(Ablation, EveryStepAddsOneThing) {
  SegmentationEvaluationOptions options;
  options.pairs.camera = "CAM_BACK";
  options.mask_directory = "masks";
  options.segmentation.motion.radar.dynamic_gain = 3.0;
  options.segmentation.motion.radar.static_gain = 0.5;
  options.segmentation.refine = options.segmentation.look_back = true;
  const std::vector<VariantResult> steps = stepsOf(options);
  ASSERT_EQ(steps.size(), 7U);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SegmentationEvaluationOptions& step = steps[i].options;
    EXPECT_EQ(step.pairs.camera, "CAM_BACK");
    EXPECT_EQ(step.segmentation.motion.score == MotionScore::kUncertainty, i >= 1) << steps[i].name;
    EXPECT_EQ(step.optical_flow.flow.forward_backward, i >= 1) << steps[i].name;
    EXPECT_EQ(step.segmentation.refine, i >= 2) << steps[i].name;
    EXPECT_EQ(step.segmentation.motion.cleanup.border, i >= 4 ? kBorder : 0) << steps[i].name;
    EXPECT_EQ(step.segmentation.look_back, i >= 5) << steps[i].name;
    EXPECT_EQ(step.segmentation.memory, i >= 6 ? kMemory : 0.0) << steps[i].name;
    EXPECT_EQ(step.segmentation.motion.radar.dynamic_gain, i >= 3 ? 3.0 : 0.0) << steps[i].name;
    EXPECT_EQ(step.segmentation.motion.radar.static_gain, i >= 3 ? 0.5 : 0.0) << steps[i].name;
  }
  EXPECT_EQ(steps[3].options.mask_directory, "masks/radar_evidence");
  const SegmentationEvaluationOptions best = bestOptions(options);
  EXPECT_EQ(best.segmentation.memory, kMemory);
  EXPECT_EQ(best.mask_directory, "masks");
  options.segmentation.memory = 0.2;
  EXPECT_EQ(stepsOf(options).back().options.segmentation.memory, 0.2);
  options.optical_flow.flow.backend = "ground_truth";  // has no flow back
  ASSERT_EQ(stepsOf(options).size(), 5U);
  options.segmentation.motion.radar.dynamic_gain = 0.0;
  EXPECT_EQ(stepsOf(options).back().options.segmentation.motion.radar.dynamic_gain,
            MotionParams{}.radar.dynamic_gain);
}

TEST(LoopComparison, TheTableHasALineForEach) {
  const std::string table = formatTable(comparison(Variants::kLoop, {report("", 30, 60, 10, 100)}));
  EXPECT_NE(table.find("v err m/s\nneither                 3     0.3000     0.3333     0.7500     0.4615     "
                       "0.2500\nmask_to_velocity "),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\nradar_to_mask "), std::string::npos) << table;
  EXPECT_NE(table.find("\nboth "), std::string::npos) << table;
}

TEST(Ablation, TheTableHasScenesAsColumns) {
  const std::string table = formatTable(
      comparison(Variants::kAblation, {report("scene-0001", 30, 60, 10, 100), report("b", 10, 20, 10, 100)}));
  EXPECT_NE(
      table.find(
          "  scene-0001           b   Overall      +- Precision    Recall        F1      FP %   mask ms\n"),
      std::string::npos)
      << table;
  EXPECT_NE(table.find(
                "\npaper                    0.300       0.250     0.286   0.016     0.333     0.667     0.444"
                "     28.57      80.0\n"),
            std::string::npos)
      << table;
}

TEST_F(SegmentationFiles, ComparisonsSumUp) {
  const SegmentationReport a = report("scene-0001", 3, 4, 10, 100), b = report("scene-0002", 7, 11, 10, 100);
  for (const Variants variants : {Variants::kLoop, Variants::kAblation}) {
    const std::string first = write("a.json", variants, {a});
    const std::string second = write("b.json", variants, {b});
    EXPECT_EQ(mergedOf({first, second}).size(), 2U);  // the scenes are there as without the comparison
    const auto merged = mergeComparison({first, second});
    ASSERT_TRUE(merged.has_value());
    EXPECT_EQ(merged->variants, variants);
    const Comparison whole = comparison(variants, {a, b});
    ASSERT_EQ(merged->results.size(), whole.results.size());
    for (std::size_t i = 0; i < whole.results.size(); ++i)
      EXPECT_EQ(merged->results[i].name, whole.results[i].name);
    EXPECT_EQ(formatTable(*merged), formatTable(whole));
    EXPECT_EQ(merged->results[1].overall.pixels.true_positives, 10U);
    EXPECT_DOUBLE_EQ(merged->results[3].overall.velocity_error.sum, 1.5);
  }
  EXPECT_FALSE(mergeComparison({write("plain.json", formatJson(std::vector{a}, a))}).has_value());
}

TEST_F(SegmentationFiles, ComparisonsThatDoNotGoTogetherAreRefused) {
  const SegmentationReport a = report("scene-0001", 30, 60, 10, 100);
  const std::string plain = write("plain.json", formatJson(std::vector{a}, a));
  const auto expect = [](const std::vector<std::string>& files, const std::vector<std::string>& parts) {
    test::expectRefusal<std::runtime_error>([&files] { mergeComparison(files); }, parts);
  };
  const std::string loop = write("loop.json", Variants::kLoop, {a});
  const std::string ablation = write("ablation.json", Variants::kAblation, {a});
  expect({loop, plain}, {plain, "'loop'", loop, "--compare-loop"});
  expect({ablation, plain}, {plain, "'ablation'", ablation, "--ablation"});
  const std::string other = write("other.json", Variants::kAblation, {a});
  test::replaceInFile(other, "\"name\": \"+ memory\"", "\"name\": \"+ luck\"");
  expect({ablation, other}, {other, "other steps"});
}

TEST_F(SegmentationFiles, EveryFieldIsCheckedByName) {
  const SegmentationReport a = report("scene-0001", 3, 4, 10, 100);
  // Behind `list`, the field gets another name.
  const auto expect = [&](Variants variants, const std::string& list, std::vector<std::string> fields) {
    for (const std::string& field : fields) {
      std::string broken = formatJson({a}, a, comparison(variants, {a}));
      broken.replace(broken.find("\"" + field + "\":", broken.find("\"" + list)) + 1, field.size(), "other");
      const std::string file = write("broken.json", broken);
      test::expectRefusal<std::runtime_error>(
          [&file] {
            mergedOf({file});
            mergeComparison({file});
          },
          {file + ": " + list + " 0", "'" + field + "'"});
    }
  };
  expect(Variants::kLoop, "scene", {"scene", "sums"});
  expect(Variants::kLoop, "loop", {"mask_to_velocity", "radar_to_mask", "overall", "sums"});
  expect(Variants::kAblation, "ablation", {"name", "scenes", "scene", "sums"});
}

}  // namespace
}  // namespace radar_dot::evaluation
