// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/ablation.h"

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
  result.seconds = 0.04;
  return result;
}

std::vector<AblationResult> results(const std::vector<SegmentationReport>& scenes) {
  AblationResult result;
  result.scenes = scenes;
  for (const SegmentationReport& scene : scenes) result.overall += scene;
  std::vector<AblationResult> all;
  for (const char* name : {"paper", "+ uncertainty"}) {
    result.name = name;
    all.push_back(result);
  }
  return all;
}

TEST(Ablation, EveryStepAddsOneThing) {
  SegmentationEvaluationOptions options;
  options.pairs.camera = "CAM_BACK";
  options.mask_directory = "masks";
  options.segmentation.motion.radar.dynamic_gain = 3.0;
  options.segmentation.motion.radar.static_gain = 0.5;
  options.segmentation.refine = options.segmentation.look_back = true;
  const std::vector<AblationStep> steps = ablationSteps(options);
  ASSERT_EQ(steps.size(), 6U);
  const char* const folders[] = {"paper",          "uncertainty", "refinement",
                                 "radar_evidence", "look_back",   "memory"};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const SegmentationEvaluationOptions& step = steps[i].options;
    EXPECT_EQ(step.pairs.camera, "CAM_BACK");
    EXPECT_EQ(step.mask_directory, std::string("masks/") + folders[i]);
    EXPECT_EQ(step.segmentation.motion.score == MotionScore::kUncertainty, i >= 1) << steps[i].name;
    EXPECT_EQ(step.optical_flow.flow.forward_backward, i >= 1) << steps[i].name;
    EXPECT_EQ(step.segmentation.refine, i >= 2) << steps[i].name;
    EXPECT_EQ(step.segmentation.look_back, i >= 4) << steps[i].name;
    EXPECT_EQ(step.segmentation.memory, i >= 5 ? kMemory : 0.0) << steps[i].name;
    EXPECT_EQ(step.segmentation.motion.radar.dynamic_gain, i >= 3 ? 3.0 : 0.0) << steps[i].name;
    EXPECT_EQ(step.segmentation.motion.radar.static_gain, i >= 3 ? 0.5 : 0.0) << steps[i].name;
  }
  const SegmentationEvaluationOptions best = bestOptions(options);
  EXPECT_EQ(best.segmentation.memory, kMemory);
  EXPECT_EQ(best.mask_directory, "masks");
  options.segmentation.memory = 0.2;
  EXPECT_EQ(ablationSteps(options).back().options.segmentation.memory, 0.2);
  options.optical_flow.flow.backend = "ground_truth";  // has no flow back
  ASSERT_EQ(ablationSteps(options).size(), 4U);
  options.segmentation.motion.radar.dynamic_gain = 0.0;
  EXPECT_EQ(ablationSteps(options).back().options.segmentation.motion.radar.dynamic_gain,
            MotionParams{}.radar.dynamic_gain);
}

TEST(Ablation, TheTableHasScenesAsColumns) {
  const std::string table = formatAblationTable(results({report("scene-0001", 30, 60), report("b", 10, 20)}));
  EXPECT_NE(
      table.find("  scene-0001           b   Overall Precision    Recall        F1      FP %   mask ms\n"),
      std::string::npos)
      << table;
  EXPECT_NE(table.find("\npaper                    0.300       0.250     0.286     0.333     0.667     0.444"
                       "     28.57      10.0\n"),
            std::string::npos)
      << table;
}

TEST(Ablation, FilesMergeSideBySide) {
  const test::TemporaryFolder folder;
  const auto write = [&folder](const char* name, const std::string& text) {
    test::writeFile(folder.path() / name, text);
    return (folder.path() / name).string();
  };
  const SegmentationReport a = report("scene-0001", 30, 60), b = report("scene-0002", 10, 20);
  const std::string first = write("a.json", formatJson({a}, a, results({a})));
  const std::string second = write("b.json", formatJson({b}, b, results({b})));
  const std::vector<AblationResult> merged = mergeAblation({first, second});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[1].name, "+ uncertainty");
  ASSERT_EQ(merged[1].scenes.size(), 2U);
  EXPECT_EQ(merged[1].scenes[1].scene, "scene-0002");
  EXPECT_EQ(merged[1].overall.pixels.true_positives, 40U);
  EXPECT_EQ(merged[1].overall.frames, 8U);
  EXPECT_TRUE(mergeAblation({write("plain.json", formatJson({a}, a))}).empty());
}

TEST(Ablation, FilesThatDoNotGoTogetherAreRefused) {
  const test::TemporaryFolder folder;
  const auto write = [&folder](const char* name, const std::string& text) {
    test::writeFile(folder.path() / name, text);
    return (folder.path() / name).string();
  };
  const SegmentationReport a = report("scene-0001", 30, 60);
  const std::string good = write("good.json", formatJson({a}, a, results({a})));
  const std::string plain = write("plain.json", formatJson({a}, a));
  test::expectRefusal<std::runtime_error>([&] { mergeAblation({good, plain}); }, {"plain.json", "ablation"});
  std::vector<AblationResult> other = results({a});
  other[1].name = "+ luck";
  const std::string steps = write("steps.json", formatJson({a}, a, other));
  test::expectRefusal<std::runtime_error>(
      [&] {
        mergeAblation({good, steps});
      },
      {"steps.json", "other steps"});
  const std::string text = formatJson({a}, a, results({a}));
  const std::string nameless = write("nameless.json", text);
  test::replaceInFile(nameless, "\"name\": \"paper\"", "\"title\": \"paper\"");
  test::expectRefusal<std::runtime_error>([&] { mergeAblation({nameless}); }, {"nameless.json", "name"});
}

}  // namespace
}  // namespace radar_dot::evaluation
