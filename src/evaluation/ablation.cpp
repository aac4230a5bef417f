// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/ablation.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "scene_images.h"
#include "segmentation_fields.h"

namespace radar_dot::evaluation {
namespace {

SegmentationReport sceneOf(const rapidjson::Value& value, const std::string& where) {
  SegmentationReport report = readCounts(value, where);
  if (!value.HasMember("scene") || !value["scene"].IsString())
    throw std::runtime_error(where + ": field 'scene' is missing or is not text");
  report.scene = value["scene"].GetString();
  return report;
}

AblationResult readResult(const rapidjson::Value& value, const std::string& where) {
  if (!value.IsObject()) throw std::runtime_error(where + ": is not an object");
  if (!value.HasMember("name") || !value["name"].IsString())
    throw std::runtime_error(where + ": field 'name' is missing or is not text");
  if (!value.HasMember("scenes") || !value["scenes"].IsArray())
    throw std::runtime_error(where + ": field 'scenes' is missing or is not a list");
  AblationResult result;
  result.name = value["name"].GetString();
  std::size_t record = 0;
  for (const rapidjson::Value& scene : value["scenes"].GetArray()) {
    result.scenes.push_back(sceneOf(scene, fmt::format("{}, scene {}", where, record++)));
    result.overall += result.scenes.back();
  }
  return result;
}

/// Adds the scenes of another file. @throws std::runtime_error for other steps.
void append(std::vector<AblationResult>& sums, const std::vector<AblationResult>& results,
            const std::string& file) {
  if (sums.empty()) {
    sums = results;
    return;
  }
  const bool same = std::equal(sums.begin(), sums.end(), results.begin(), results.end(),
                               [](const auto& a, const auto& b) { return a.name == b.name; });
  if (!same) throw std::runtime_error(file + ": its list 'ablation' has other steps than those before");
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i].scenes.insert(sums[i].scenes.end(), results[i].scenes.begin(), results[i].scenes.end());
    sums[i].overall += results[i].overall;
  }
}

}  // namespace

std::vector<AblationStep> ablationSteps(const SegmentationEvaluationOptions& options) {
  const DynamicSegmentationConfig& given = options.segmentation;
  SegmentationEvaluationOptions step = options;
  DynamicSegmentationConfig& segmentation = step.segmentation;
  segmentation.motion.score = MotionScore::kPaper;
  segmentation.motion.radar.dynamic_gain = segmentation.motion.radar.static_gain = 0.0;
  segmentation.refine = segmentation.look_back = false;
  segmentation.memory = 0.0;
  std::vector<AblationStep> steps;
  const auto add = [&](const std::string& name, const std::string& folder) {
    if (!options.mask_directory.empty()) step.mask_directory = options.mask_directory + "/" + folder;
    steps.push_back({name, step});
  };
  add("paper", "paper");
  segmentation.motion.score = MotionScore::kUncertainty;
  step.optical_flow.flow.forward_backward = true;
  add("+ uncertainty", "uncertainty");
  segmentation.refine = segmentation.refine_ground = true;
  add("+ refinement", "refinement");
  segmentation.motion.radar.dynamic_gain = given.motion.radar.dynamic_gain > 0.0
                                               ? given.motion.radar.dynamic_gain
                                               : MotionParams{}.radar.dynamic_gain;
  segmentation.motion.radar.static_gain = given.motion.radar.static_gain;
  add("+ radar evidence", "radar_evidence");
  if (fileSourceOf(options.optical_flow.flow.backend))
    return steps;  // the truth and files have no backward flow
  segmentation.look_back = true;
  add("+ look back", "look_back");
  segmentation.memory = given.memory > 0.0 ? given.memory : kMemory;
  add("+ memory", "memory");
  return steps;
}

SegmentationEvaluationOptions bestOptions(const SegmentationEvaluationOptions& options) {
  SegmentationEvaluationOptions best = ablationSteps(options).back().options;
  best.mask_directory = options.mask_directory;
  return best;
}

std::string formatAblationTable(const std::vector<AblationResult>& results) {
  if (results.empty()) return {};
  std::string table = fmt::format("{:<18}", "IoU");
  for (const SegmentationReport& scene : results.front().scenes) table += fmt::format("{:>12}", scene.scene);
  for (const char* name : {"Overall", "Precision", "Recall", "F1", "FP %", "mask ms"})
    table += fmt::format("{:>10}", name);
  table += "\n";
  for (const AblationResult& result : results) {
    table += fmt::format("{:<18}", result.name);
    for (const SegmentationReport& scene : result.scenes)
      table += fmt::format("{:>12}", figure(scene.iou(), 3));
    const SegmentationReport& overall = result.overall;
    for (const double value :
         {overall.iou(), overall.pixels.precision(), overall.pixels.recall(), overall.pixels.f1()})
      table += fmt::format("{:>10}", figure(value, 3));
    table += fmt::format("{:>10}", figure(1e2 * overall.falsePositiveShare(), 2));
    table += fmt::format("{:>10}\n", figure(1e3 * overall.seconds / static_cast<double>(overall.frames), 1));
  }
  return table;
}

std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const std::vector<AblationResult>& results) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  const auto write = [&writer](const SegmentationReport& report, bool is_overall) {
    writeReport(writer, report, is_overall);
  };
  writeScenes(writer, scenes, overall, write, [&] {
    writer.Key("ablation");
    writer.StartArray();
    for (const AblationResult& result : results) {
      writeScenes(writer, result.scenes, result.overall, write, [&] {
        writer.Key("name");
        writer.String(result.name.c_str());
      });
    }
    writer.EndArray();
  });
  return std::string(buffer.GetString(), buffer.GetSize()) + "\n";
}

std::vector<AblationResult> mergeAblation(const std::vector<std::string>& files) {
  std::vector<AblationResult> sums;
  std::string with, without;
  for (const std::string& file : files) {
    const rapidjson::Document document = evaluation::readResult(file);
    if (!document.HasMember("ablation")) {
      without = file;
      continue;
    }
    with = file;
    if (!document["ablation"].IsArray()) throw std::runtime_error(file + ": field 'ablation' is not a list");
    std::vector<AblationResult> results;
    for (const rapidjson::Value& value : document["ablation"].GetArray())
      results.push_back(readResult(value, fmt::format("{}: ablation {}", file, results.size())));
    append(sums, results, file);
  }
  if (!with.empty() && !without.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: has no list 'ablation', which {} has; both must be results of --ablation", without, with));
  }
  return sums;
}

}  // namespace radar_dot::evaluation
