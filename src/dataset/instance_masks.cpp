// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/instance_masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "json_records.h"

namespace radar_dot::dataset {
namespace {

constexpr int kMaxSide = 1 << 15;  ///< px
constexpr std::size_t kMinPolygonNumbers = 6;

enum { kToken, kSampleData, kFilename, kBox, kCategory, kMask, kAttributes };

std::filesystem::path maskFile(const Tables& tables) {
  return tables.dataroot() / tables.version() / "nuinsseg.json";
}

/// One side of {"size": [rows, columns]}.
int sideOf(const Record& record, const JsonValue& side) {
  if (!side.IsNumber() || !(side.GetDouble() >= 1.0 && side.GetDouble() <= kMaxSide))
    record.fail(kMask, fmt::format("must have a size of two numbers in 1..{}", kMaxSide));
  return static_cast<int>(side.GetDouble());
}

/// Run lengths as plain numbers.
RunLengthMask plainRunLengths(const Record& record, const JsonValue& counts, int rows, int columns) {
  RunLengthMask mask{rows, columns, {}};
  std::uint64_t sum = 0;
  const auto area = static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns);
  for (const JsonValue& run : counts.GetArray()) {
    if (!run.IsNumber() || !(run.GetDouble() >= 0.0 && run.GetDouble() <= static_cast<double>(area)))
      record.fail(kMask, "has a run length that does not fit its size");
    mask.counts.push_back(static_cast<std::uint32_t>(run.GetDouble()));
    sum += mask.counts.back();
  }
  if (sum != area)
    record.fail(kMask, fmt::format("has run lengths that add up to {}, not to {} x {}", sum, rows, columns));
  return mask;
}

RunLengthMask runLengthsOf(const Record& record, const JsonValue& value) {
  if (!value.HasMember("size") || !value.HasMember("counts"))
    record.fail(kMask, "has a part without size or counts");
  const JsonValue& size = value["size"];
  const JsonValue& counts = value["counts"];
  if (!size.IsArray() || size.Size() != 2) record.fail(kMask, "must have a size of two numbers");
  const int rows = sideOf(record, size[0U]);
  const int columns = sideOf(record, size[1U]);
  if (counts.IsArray()) return plainRunLengths(record, counts, rows, columns);
  if (!counts.IsString()) record.fail(kMask, "must have counts that are a text or a list of numbers");
  try {
    return parseRunLengths(textOf(counts), rows, columns);
  } catch (const std::invalid_argument& error) {
    record.fail(kMask, fmt::format("cannot be decoded: {}", error.what()));
  }
}

/// Empty where it encloses nothing.
Polygon polygonOf(const Record& record, const JsonValue& value) {
  Polygon polygon;
  for (const JsonValue& number : value.GetArray()) {
    if (!number.IsNumber() || !(std::abs(number.GetDouble()) <= kMaxSide))
      record.fail(kMask,
                  fmt::format("has a polygon with a coordinate that is no number within +-{}", kMaxSide));
    polygon.push_back(number.GetDouble());
  }
  if (polygon.size() % 2 != 0)
    record.fail(kMask, fmt::format("has a polygon of {} numbers, which are no x y pairs", polygon.size()));
  if (polygon.size() < kMinPolygonNumbers) polygon.clear();
  return polygon;
}

/// @throws ValueError where nothing is left of it
void readMask(const Record& record, InstanceMask& row) {
  const JsonValue& value = record.value(kMask);
  if (value.IsNull()) record.failForValue(kMask, "is null");
  if (!value.IsObject() && !value.IsArray())
    record.fail(kMask, "must be run lengths {size, counts}, a list of those or a list of polygons");
  const bool is_list = value.IsArray();
  std::vector<RunLengthMask> runs;
  std::vector<Polygon> polygons;
  for (const JsonValue* part = is_list ? value.Begin() : &value; part != (is_list ? value.End() : &value + 1);
       ++part) {
    if (part->IsObject())
      runs.push_back(runLengthsOf(record, *part));
    else if (part->IsArray())
      polygons.push_back(polygonOf(record, *part));
    else if (!part->IsNull())
      record.fail(kMask, "must hold run lengths {size, counts} or polygons");
    if (!runs.empty() && row.image.empty()) row.image = {runs.back().columns, runs.back().rows};
    if (!runs.empty() && (runs.back().rows != row.image.height || runs.back().columns != row.image.width))
      record.failForValue(kMask,
                          fmt::format("is of {} x {} pixels, its image of {} x {}", runs.back().columns,
                                      runs.back().rows, row.image.width, row.image.height));
  }
  if (!runs.empty() && !polygons.empty()) record.fail(kMask, "mixes run lengths and polygons");
  polygons.erase(std::remove_if(polygons.begin(), polygons.end(), [](const Polygon& p) { return p.empty(); }),
                 polygons.end());
  if (runs.empty() && polygons.empty()) record.failForValue(kMask, "encloses nothing");
  if (row.image.empty()) row.image = InstanceMask().image;
  if (runs.empty())
    row.mask = std::move(polygons);
  else
    row.mask = std::move(runs);
}

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

cv::Mat emptyCanvas() { return cv::Mat::zeros(kMaskRows, kMaskColumns, CV_8UC1); }

cv::Size canvasOf(const InstanceMask& instance) {
  const auto* runs = std::get_if<std::vector<RunLengthMask>>(&instance.mask);
  if (runs == nullptr || runs->empty()) return instance.image;
  return {runs->front().columns, runs->front().rows};
}

void unite(cv::Mat& canvas, const cv::Mat& part) {
  if (part.size() != canvas.size())
    throw std::invalid_argument(fmt::format("masks of {}x{} and {}x{} pixels cannot be united", canvas.cols,
                                            canvas.rows, part.cols, part.rows));
  cv::bitwise_or(canvas, part, canvas);
}

}  // namespace

std::vector<std::vector<const InstanceMask*>> byScene(const Tables& tables,
                                                      const std::vector<InstanceMask>& masks) {
  std::vector<std::vector<const InstanceMask*>> scenes(tables.scenes.size());
  for (const InstanceMask& mask : masks) {
    const Index reading = tables.findReading(mask.sample_data_token);
    const Index sample = tables.sample_data[static_cast<std::size_t>(reading)].sample;
    scenes[static_cast<std::size_t>(tables.samples[static_cast<std::size_t>(sample)].scene)].push_back(&mask);
  }
  return scenes;
}

bool hasInstanceMasks(const Tables& tables) { return std::filesystem::exists(maskFile(tables)); }

std::vector<InstanceMask> readInstanceMasks(Tables& tables, const std::filesystem::path& file) {
  const std::filesystem::path source = file.empty() ? maskFile(tables) : file;
  const std::string label = file.empty() ? tables.version() + "/nuinsseg.json" : file.string();
  std::vector<InstanceMask> rows;
  std::size_t skipped = 0;
  std::string reason;
  readRecords(source, label,
              {"token", "sample_data_token", "filename", "bbox_corners", "category_name", "instance_mask",
               "attribute_tokens"},
              [&](const Record& record) {
                const Token reading = tables.tokens.find(record.text(kSampleData));
                if (tables.findReading(reading) == kNone) return;
                InstanceMask row;
                row.token = tables.tokens.intern(record.text(kToken));
                row.sample_data_token = reading;
                row.filename = record.text(kFilename);
                row.bounding_box = record.numbers<4>(kBox);
                row.category_name = record.text(kCategory);
                for (const std::string_view token : record.texts(kAttributes))
                  row.attribute_tokens.push_back(tables.tokens.intern(token));
                const SampleData& image = at(tables.sample_data, tables.findReading(reading));
                row.image = {image.width, image.height};
                try {
                  readMask(record, row);
                  rows.push_back(std::move(row));
                } catch (const ValueError& error) {
                  if (skipped++ == 0) reason = error.what();
                }
              });
  if (skipped > 0)
    tables.left_out.add(label, fmt::format("{} of {} instances, the first because: {}", skipped,
                                           skipped + rows.size(), reason));
  return rows;
}

cv::Mat decodeMask(const InstanceMask& instance) {
  cv::Mat canvas = cv::Mat::zeros(canvasOf(instance), CV_8UC1);
  if (const auto* runs = std::get_if<std::vector<RunLengthMask>>(&instance.mask)) {
    for (const RunLengthMask& part : *runs) unite(canvas, decodeMask(part));
    return canvas;
  }
  for (const Polygon& polygon : std::get<std::vector<Polygon>>(instance.mask)) {
    std::vector<cv::Point> corners;
    for (std::size_t i = 0; i + 1 < polygon.size(); i += 2)
      corners.emplace_back(static_cast<int>(std::lround(polygon[i])),
                           static_cast<int>(std::lround(polygon[i + 1])));
    // One call each: polygons of one call would cut holes where they overlap.
    cv::fillPoly(canvas, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255));
  }
  return canvas;
}

bool isMovingAttribute(std::string_view name) noexcept {
  return endsWith(name, ".moving") || name == "cycle.with_rider";
}

bool isMoving(const Tables& tables, const InstanceMask& instance) {
  return std::any_of(tables.attributes.begin(), tables.attributes.end(), [&](const Attribute& attribute) {
    const auto& tokens = instance.attribute_tokens;
    return isMovingAttribute(attribute.name) &&
           std::find(tokens.begin(), tokens.end(), attribute.token) != tokens.end();
  });
}

bool isMoving(const Tables& tables, const SampleAnnotation& annotation) {
  return std::any_of(annotation.attributes.begin(), annotation.attributes.end(), [&](Index attribute) {
    return isMovingAttribute(at(tables.attributes, attribute).name);
  });
}

cv::Mat dynamicMask(const Tables& tables, const std::vector<const InstanceMask*>& instances) {
  cv::Mat canvas =
      instances.empty() ? emptyCanvas() : cv::Mat(cv::Mat::zeros(canvasOf(*instances.front()), CV_8UC1));
  for (const InstanceMask* instance : instances)
    if (isMoving(tables, *instance)) unite(canvas, decodeMask(*instance));
  return canvas;
}

}  // namespace radar_dot::dataset
