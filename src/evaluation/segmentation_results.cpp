// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "report_format.h"
#include "scene_images.h"

namespace radar_dot::evaluation {
namespace {

/// The name of the list in files.
const char* keyOf(Variants variants) { return variants == Variants::kLoop ? "loop" : "ablation"; }

/// By radar_to_mask, and in it by mask_to_velocity.
constexpr const char* kLoopNames[] = {"neither", "mask_to_velocity", "radar_to_mask", "both"};
constexpr const char* kDirections[] = {"mask_to_velocity", "radar_to_mask"};

std::size_t loopIndexOf(const SegmentationEvaluationOptions& options) {
  return (options.mask_to_velocity ? 1U : 0U) +
         (options.segmentation.motion.radar.dynamic_gain != 0.0 ? 2U : 0U);
}

std::size_t loopIndexOf(const std::string& name) {
  return static_cast<std::size_t>(std::find(std::begin(kLoopNames), std::end(kLoopNames), name) -
                                  std::begin(kLoopNames));
}

std::vector<VariantResult> loopVariants(const SegmentationEvaluationOptions& options) {
  std::vector<VariantResult> variants;
  const double given = options.segmentation.motion.radar.dynamic_gain;
  const double gain = given != 0.0 ? given : MotionParams{}.radar.dynamic_gain;
  for (std::size_t i = 0; i < std::size(kLoopNames); ++i) {
    SegmentationEvaluationOptions variant = options;
    variant.mask_to_velocity = (i & 1U) != 0;
    variant.segmentation.motion.radar.dynamic_gain = (i & 2U) != 0 ? gain : 0.0;
    if (i != loopIndexOf(options)) variant.mask_directory.clear();
    variants.push_back({kLoopNames[i], variant, {}, {}});
  }
  return variants;
}

std::vector<VariantResult> ablationSteps(const SegmentationEvaluationOptions& options) {
  const DynamicSegmentationConfig& given = options.segmentation;
  SegmentationEvaluationOptions step = options;
  DynamicSegmentationConfig& segmentation = step.segmentation;
  std::vector<VariantResult> steps;
  const auto add = [&](const std::string& name, const std::string& folder) {
    if (!options.mask_directory.empty()) step.mask_directory = options.mask_directory + "/" + folder;
    steps.push_back({name, step, {}, {}});
  };
  segmentation.motion.score = MotionScore::kPaper;
  segmentation.motion.radar.dynamic_gain = segmentation.motion.radar.static_gain = 0.0;
  segmentation.refine = segmentation.look_back = false;
  segmentation.memory = 0.0;
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
  segmentation.motion.cleanup.border =
      given.motion.cleanup.border > 0 ? given.motion.cleanup.border : kBorder;
  add("+ image borders", "image_borders");
  if (fileSourceOf(options.optical_flow.flow.backend))
    return steps;  // the truth and files have no backward flow
  segmentation.look_back = true;
  add("+ look back", "look_back");
  segmentation.memory = given.memory > 0.0 ? given.memory : kMemory;
  add("+ memory", "memory");
  return steps;
}

SegmentationReport reportOf(const rapidjson::Value& value, const std::string& where) {
  SegmentationReport report;
  figuresOf(report).readSums(
      memberOf(value, "sums", &rapidjson::Value::IsString, "a text", where).GetString(), where);
  return report;
}

SegmentationReport sceneOf(const rapidjson::Value& value, const std::string& where) {
  SegmentationReport report = reportOf(value, where);
  report.scene = memberOf(value, "scene", &rapidjson::Value::IsString, "a text", where).GetString();
  return report;
}

VariantResult variantOf(Variants variants, const rapidjson::Value& value, const std::string& where) {
  VariantResult result;
  if (variants == Variants::kLoop) {
    std::size_t index = 0;
    for (std::size_t i = 0; i < std::size(kDirections); ++i)
      if (memberOf(value, kDirections[i], &rapidjson::Value::IsBool, "true or false", where).GetBool())
        index += std::size_t{1} << i;
    result.name = kLoopNames[index];
    const auto& overall = memberOf(value, "overall", &rapidjson::Value::IsObject, "an object", where);
    result.overall = reportOf(overall, where + ", overall");
    return result;
  }
  result.name = memberOf(value, "name", &rapidjson::Value::IsString, "a text", where).GetString();
  for (const auto& scene :
       memberOf(value, "scenes", &rapidjson::Value::IsArray, "a list", where).GetArray()) {
    result.scenes.push_back(sceneOf(scene, fmt::format("{}, scene {}", where, result.scenes.size())));
    result.overall += result.scenes.back();
  }
  return result;
}

/// Adds those of another file. @throws std::runtime_error for other variants
void append(std::vector<VariantResult>& sums, const std::vector<VariantResult>& results,
            const std::string& file, const char* key) {
  if (sums.empty()) {
    sums = results;
    return;
  }
  const bool same = std::equal(sums.begin(), sums.end(), results.begin(), results.end(),
                               [](const auto& a, const auto& b) { return a.name == b.name; });
  if (!same)
    throw std::runtime_error(fmt::format("{}: its list '{}' has other steps than those before", file, key));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i].scenes.insert(sums[i].scenes.end(), results[i].scenes.begin(), results[i].scenes.end());
    sums[i].overall += results[i].overall;
  }
}

std::vector<VariantResult> merge(Variants variants, const std::vector<std::string>& files) {
  const char* key = keyOf(variants);
  std::vector<VariantResult> sums;
  std::string with, without;
  for (const std::string& file : files) {
    const rapidjson::Document document = readReport(file);
    if (!document.HasMember(key)) {
      without = file;
      continue;
    }
    with = file;
    std::vector<VariantResult> results;
    for (const auto& value : memberOf(document, key, &rapidjson::Value::IsArray, "a list", file).GetArray())
      results.push_back(variantOf(variants, value, fmt::format("{}: {} {}", file, key, results.size())));
    append(sums, results, file, key);
  }
  if (!with.empty() && !without.empty()) {
    throw std::runtime_error(fmt::format("{}: has no list '{}', which {} has; both must be results of --{}",
                                         without, key, with,
                                         variants == Variants::kLoop ? "compare-loop" : key));
  }
  return sums;
}

}  // namespace

Comparison comparisonOf(Variants variants, const SegmentationEvaluationOptions& options) {
  return {variants, variants == Variants::kLoop ? loopVariants(options) : ablationSteps(options)};
}

std::size_t ownVariant(const Comparison& comparison, const SegmentationEvaluationOptions& options) {
  return comparison.variants == Variants::kLoop ? loopIndexOf(options) : comparison.results.size() - 1;
}

SegmentationEvaluationOptions bestOptions(const SegmentationEvaluationOptions& options) {
  SegmentationEvaluationOptions best = ablationSteps(options).back().options;
  best.mask_directory = options.mask_directory;
  return best;
}

std::string formatTable(const Comparison& comparison) {
  std::vector<Row> rows;
  for (const VariantResult& result : comparison.results) {
    rows.emplace_back(result.name, figuresOf(result.overall));
    for (const SegmentationReport& scene : result.scenes)
      rows.back().second.column("iou/" + scene.scene, scene.iou());
  }
  if (comparison.variants == Variants::kLoop) {
    return tableOf("Loop", 18, rows,
                   {{"Frames", 7, "frames"},
                    {"IoU", 11, "iou", 4},
                    {"Precision", 11, "precision", 4},
                    {"Recall", 11, "recall", 4},
                    {"F1", 11, "f1", 4},
                    {"v err m/s", 11, "velocity_error", 4}});
  }
  std::vector<Column> columns;
  for (const SegmentationReport& scene : comparison.results.front().scenes)
    columns.push_back({scene.scene, 12, "iou/" + scene.scene});
  for (const Column& column : {Column{"Overall", 10, "iou"},
                               {"+-", 8, "iou_error"},
                               {"Precision", 10, "precision"},
                               {"Recall", 10, "recall"},
                               {"F1", 10, "f1"},
                               {"FP %", 10, "false_positive_share", 2, 1e2},
                               {"mask ms", 10, "mask_ms", 1}})
    columns.push_back(column);
  return tableOf("IoU", 18, rows, columns);
}

std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const Comparison& comparison) {
  return jsonText([&](JsonWriter& writer) {
    writeScenes(writer, figuresOf(scenes), figuresOf(overall), [&] {
      writer.Key(keyOf(comparison.variants));
      writer.StartArray();
      for (const VariantResult& result : comparison.results) {
        if (comparison.variants == Variants::kAblation) {
          writeScenes(writer, figuresOf(result.scenes), figuresOf(result.overall), [&] {
            writer.Key("name");
            writer.String(result.name.c_str());
          });
          continue;
        }
        writer.StartObject();
        for (std::size_t i = 0; i < std::size(kDirections); ++i) {
          writer.Key(kDirections[i]);
          writer.Bool((loopIndexOf(result.name) >> i & 1U) != 0);
        }
        writer.Key("overall");
        writeReport(writer, figuresOf(result.overall), true);
        writer.EndObject();
      }
      writer.EndArray();
    });
  });
}

std::optional<Comparison> mergeComparison(const std::vector<std::string>& files) {
  for (const Variants variants : {Variants::kLoop, Variants::kAblation})
    if (std::vector<VariantResult> results = merge(variants, files); !results.empty())
      return Comparison{variants, std::move(results)};
  return std::nullopt;
}

}  // namespace radar_dot::evaluation
