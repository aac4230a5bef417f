// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <rapidjson/document.h>
#include <rapidjson/error/en.h>
#include <rapidjson/istreamwrapper.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "report_format.h"
#include "segmentation_fields.h"

namespace radar_dot::evaluation {
namespace {

/// The counts of a report, as files name them.
template <typename Report>
auto countsOf(Report& report) {
  return std::array{
      std::pair{"frames", &report.frames},
      std::pair{"without_motion", &report.without_motion},
      std::pair{"true_positives", &report.pixels.true_positives},
      std::pair{"false_positives", &report.pixels.false_positives},
      std::pair{"false_negatives", &report.pixels.false_negatives},
      std::pair{"true_negatives", &report.pixels.true_negatives},
      std::pair{"velocity_error_count", &report.velocity_error.count},
  };
}

/// Its sums.
template <typename Report>
auto sumsOf(Report& report) {
  return std::array{
      std::pair{"seconds", &report.seconds},
      std::pair{"velocity_error_sum", &report.velocity_error.sum},
  };
}

std::string row(const SegmentationReport& report, const std::string& name) {
  std::string line = fmt::format("{:<14}{:>7}", name, report.frames);
  for (const auto& [key, value] : figuresOf(report)) line += fmt::format("{:>11}", figure(value, 4));
  const double pairs = static_cast<double>(report.frames - report.without_motion);
  line += fmt::format("{:>9}\n", figure(1e3 * report.seconds / pairs, 1));
  return line;
}

}  // namespace

std::array<std::pair<const char*, double>, 6> figuresOf(const SegmentationReport& report) {
  return {{{"iou", report.iou()},
           {"precision", report.pixels.precision()},
           {"recall", report.pixels.recall()},
           {"f1", report.pixels.f1()},
           {"false_positive_share", report.falsePositiveShare()},
           {"velocity_error", report.velocity_error.value()}}};
}

void writeReport(JsonWriter& writer, const SegmentationReport& report, bool overall) {
  writer.StartObject();
  if (!overall) {
    writer.Key("scene");
    writer.String(report.scene.c_str());
  }
  for (const auto& [key, value] : figuresOf(report)) number(writer, key, value);
  for (const auto& [key, value] : countsOf(report)) count(writer, key, *value);
  for (const auto& [key, value] : sumsOf(report)) number(writer, key, *value);
  writer.EndObject();
}

SegmentationReport readCounts(const rapidjson::Value& value, const std::string& where) {
  const auto refuse = [&where](const char* field, const char* wanted) -> std::runtime_error {
    return std::runtime_error(fmt::format("{}: field '{}' is missing or is not {}", where, field, wanted));
  };
  if (!value.IsObject()) throw std::runtime_error(where + ": is not an object");
  SegmentationReport report;
  for (const auto& [key, target] : countsOf(report)) {
    if (!value.HasMember(key) || !value[key].IsUint64()) throw refuse(key, "a count");
    *target = value[key].GetUint64();
  }
  for (const char* part : {"without_motion", "velocity_error_count"})
    if (value[part].GetUint64() > report.frames) throw refuse(part, "at most 'frames'");
  for (const auto& [key, target] : sumsOf(report)) {
    if (!value.HasMember(key) || !value[key].IsNumber()) throw refuse(key, "a number");
    *target = value[key].GetDouble();
    if (*target < 0.0) throw refuse(key, "0 or more");
  }
  return report;
}

rapidjson::Document readResult(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be opened");
  rapidjson::IStreamWrapper wrapper(stream);
  rapidjson::Document document;
  // Not recursive: a file nested deeply is an error, not the end of the stack.
  document.ParseStream<rapidjson::kParseIterativeFlag>(wrapper);
  if (document.HasParseError()) {
    throw std::runtime_error(fmt::format("{}: byte {}: {}", file, document.GetErrorOffset(),
                                         rapidjson::GetParseError_En(document.GetParseError())));
  }
  if (!document.IsObject() || !document.HasMember("scenes") || !document["scenes"].IsArray())
    throw std::runtime_error(file +
                             ": has no list 'scenes'; it must be a result of evaluate_segmentation --json");
  return document;
}

double SegmentationReport::iou() const {
  const std::size_t either = pixels.true_positives + pixels.false_positives + pixels.false_negatives;
  return either == 0 ? std::numeric_limits<double>::quiet_NaN()
                     : static_cast<double>(pixels.true_positives) / static_cast<double>(either);
}

double SegmentationReport::falsePositiveShare() const {
  const std::size_t still = pixels.false_positives + pixels.true_negatives;
  return still == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : static_cast<double>(pixels.false_positives) / static_cast<double>(still);
}

SegmentationReport& SegmentationReport::operator+=(const SegmentationReport& other) {
  frames += other.frames;
  without_motion += other.without_motion;
  pixels += other.pixels;
  seconds += other.seconds;
  velocity_error += other.velocity_error;
  return *this;
}

std::string formatTable(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall) {
  std::string table = fmt::format("{:<14}{:>7}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}{:>9}\n", "Scene", "Frames",
                                  "IoU", "Precision", "Recall", "F1", "FP share", "v err m/s", "mask ms");
  for (const SegmentationReport& scene : scenes) table += row(scene, scene.scene);
  return table + row(overall, "Overall");
}

std::string formatJson(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  writeScenes(writer, scenes, overall, [&writer](const SegmentationReport& report, bool is_overall) {
    writeReport(writer, report, is_overall);
  });
  return std::string(buffer.GetString(), buffer.GetSize()) + "\n";
}

std::string formatCsv(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall) {
  std::string text = "scene";
  for (const auto& [key, value] : figuresOf(overall)) text += fmt::format(",{}", key);
  for (const auto& [key, value] : countsOf(overall)) text += fmt::format(",{}", key);
  for (const auto& [key, value] : sumsOf(overall)) text += fmt::format(",{}", key);
  text += "\n";
  const auto line = [&text](const SegmentationReport& report, const std::string& name) {
    text += name;
    for (const auto& [key, value] : figuresOf(report))
      text += std::isfinite(value) ? fmt::format(",{:.6f}", value) : ",";
    for (const auto& [key, value] : countsOf(report)) text += fmt::format(",{}", *value);
    for (const auto& [key, value] : sumsOf(report)) text += fmt::format(",{:.6f}", *value);
    text += "\n";
  };
  for (const SegmentationReport& scene : scenes) line(scene, scene.scene);
  line(overall, "overall");
  return text;
}

std::vector<SegmentationReport> mergeJson(const std::vector<std::string>& files) {
  std::map<std::string, SegmentationReport> by_name;
  std::map<std::string, std::string> file_of;
  for (const std::string& file : files) {
    const rapidjson::Document document = readResult(file);
    std::size_t record = 0;
    for (const rapidjson::Value& value : document["scenes"].GetArray()) {
      const std::string where = fmt::format("{}: scene {}", file, record++);
      SegmentationReport report = readCounts(value, where);
      if (!value.HasMember("scene") || !value["scene"].IsString())
        throw std::runtime_error(where + ": field 'scene' is missing or is not a text");
      report.scene = value["scene"].GetString();
      const std::string name = report.scene;
      if (const auto [found, is_new] = file_of.try_emplace(name, file); !is_new) {
        throw std::runtime_error(
            fmt::format("{}: {} also stands in {}; its pixels would count twice", file, name, found->second));
      }
      by_name.emplace(name, std::move(report));
    }
  }
  std::vector<SegmentationReport> scenes;
  for (auto& [name, report] : by_name) scenes.push_back(std::move(report));
  return scenes;
}

}  // namespace radar_dot::evaluation
