// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/loop_comparison.h"

#include <fmt/format.h>

#include <stdexcept>

#include "segmentation_fields.h"

namespace radar_dot::evaluation {
namespace {

bool isRadarToMask(const SegmentationEvaluationOptions& options) {
  return options.segmentation.motion.radar.dynamic_gain != 0.0;
}

const char* nameOf(const LoopResult& result) {
  if (result.mask_to_velocity) return result.radar_to_mask ? "both" : "mask_to_velocity";
  return result.radar_to_mask ? "radar_to_mask" : "neither";
}

LoopResult readLoopResult(const rapidjson::Value& value, const std::string& where) {
  if (!value.IsObject()) throw std::runtime_error(where + ": is not an object");
  LoopResult result;
  for (const auto& [key, target] : {std::pair{"mask_to_velocity", &result.mask_to_velocity},
                                    std::pair{"radar_to_mask", &result.radar_to_mask}}) {
    if (!value.HasMember(key) || !value[key].IsBool())
      throw std::runtime_error(fmt::format("{}: field '{}' is missing or is not true or false", where, key));
    *target = value[key].GetBool();
  }
  if (!value.HasMember("overall"))
    throw std::runtime_error(where + ": field 'overall' is missing or is not an object");
  result.overall = readCounts(value["overall"], where + ", overall");
  return result;
}

/// Adds a result to that of the same directions.
void add(std::vector<LoopResult>& sums, const LoopResult& result) {
  for (LoopResult& sum : sums) {
    if (sum.mask_to_velocity != result.mask_to_velocity || sum.radar_to_mask != result.radar_to_mask)
      continue;
    sum.overall += result.overall;
    return;
  }
  sums.push_back(result);
}

}  // namespace

std::vector<SegmentationEvaluationOptions> loopVariants(const SegmentationEvaluationOptions& options) {
  std::vector<SegmentationEvaluationOptions> variants;
  const double gain = isRadarToMask(options) ? options.segmentation.motion.radar.dynamic_gain
                                             : MotionParams{}.radar.dynamic_gain;
  for (const bool radar_to_mask : {false, true}) {
    for (const bool mask_to_velocity : {false, true}) {
      SegmentationEvaluationOptions variant = options;
      variant.mask_to_velocity = mask_to_velocity;
      variant.segmentation.motion.radar.dynamic_gain = radar_to_mask ? gain : 0.0;
      if (variants.size() != ownVariant(options)) variant.mask_directory.clear();
      variants.push_back(variant);
    }
  }
  return variants;
}

std::size_t ownVariant(const SegmentationEvaluationOptions& options) {
  return (options.mask_to_velocity ? 1U : 0U) + (isRadarToMask(options) ? 2U : 0U);
}

std::string formatLoopTable(const std::vector<LoopResult>& results) {
  std::string table = fmt::format("{:<18}{:>7}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "Loop", "Frames", "IoU",
                                  "Precision", "Recall", "F1", "v err m/s");
  for (const LoopResult& result : results) {
    const SegmentationReport& overall = result.overall;
    table += fmt::format("{:<18}{:>7}", nameOf(result), overall.frames);
    for (const double value : {overall.iou(), overall.pixels.precision(), overall.pixels.recall(),
                               overall.pixels.f1(), overall.velocity_error.value()})
      table += fmt::format("{:>11}", figure(value, 4));
    table += "\n";
  }
  return table;
}

std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall,
                       const std::vector<LoopResult>& results) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  const auto write = [&writer](const SegmentationReport& report, bool is_overall) {
    writeReport(writer, report, is_overall);
  };
  writeScenes(writer, scenes, overall, write, [&writer, &results] {
    writer.Key("loop");
    writer.StartArray();
    for (const LoopResult& result : results) {
      writer.StartObject();
      writer.Key("mask_to_velocity");
      writer.Bool(result.mask_to_velocity);
      writer.Key("radar_to_mask");
      writer.Bool(result.radar_to_mask);
      writer.Key("overall");
      writeReport(writer, result.overall, true);
      writer.EndObject();
    }
    writer.EndArray();
  });
  return std::string(buffer.GetString(), buffer.GetSize()) + "\n";
}

std::vector<LoopResult> mergeLoop(const std::vector<std::string>& files) {
  std::vector<LoopResult> sums;
  std::string with, without;
  for (const std::string& file : files) {
    const rapidjson::Document document = readResult(file);
    if (!document.HasMember("loop")) {
      without = file;
      continue;
    }
    with = file;
    if (!document["loop"].IsArray()) throw std::runtime_error(file + ": field 'loop' is not a list");
    std::size_t record = 0;
    for (const rapidjson::Value& value : document["loop"].GetArray())
      add(sums, readLoopResult(value, fmt::format("{}: loop {}", file, record++)));
  }
  if (!with.empty() && !without.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: has no list 'loop', which {} has; both must be results of --compare-loop", without, with));
  }
  return sums;
}

}  // namespace radar_dot::evaluation
