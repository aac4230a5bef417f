// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/flow_evaluation.h"

#include <fmt/format.h>

#include <chrono>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "report_format.h"
#include "scene_images.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using dataset::DatasetError;
using dataset::Index;
using dataset::Tables;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool isExpected(const FlowEvaluationOptions& options) {
  return options.optical_flow.flow.initialisation == FlowStart::kExpected;
}

/// The part of the options of a segmentation that its images look at.
SegmentationEvaluationOptions imageOptionsOf(const FlowEvaluationOptions& options) {
  SegmentationEvaluationOptions images;
  images.optical_flow = options.optical_flow;
  images.depth = options.depth;
  // Without a start from it depth is not looked at.
  if (!isExpected(options)) images.depth.depth.backend = toString(FileSource::kGroundTruth);
  images.pairs = options.pairs;
  images.depth_input = options.depth_input;
  return images;
}

void requireTruth(const Tables& tables, const FlowEvaluationOptions& options) {
  const fs::path folder = tables.dataroot() / "ground_truth" /
                          (options.pairs.pairs == ImagePairs::kKeyframes ? "keyframe_flow" : "flow");
  if (fs::is_directory(folder)) return;
  throw DatasetError(folder.string() + ": is not there; the true flow is that of a simulated dataroot");
}

void evaluatePair(SceneImages& images, const ImagePair& pair, const FlowEvaluationOptions& options,
                  FlowReport& report) {
  images.begin(pair);
  const dataset::SampleData& first = images.reading(pair.first);
  if (isExpected(options)) images.depthOf(pair.first);  // read before the time counts, as the images
  const bool is_estimated = !fileSourceOf(options.optical_flow.flow.backend);
  if (is_estimated) {
    images.imageOf(pair.first);
    images.imageOf(pair.second);
  }
  const Clock::time_point start = Clock::now();
  const FlowField field = images.flowOf(pair, images.trueMotion(pair));
  if (is_estimated) report.seconds.push_back(secondsSince(start));
  report.errors.add(field, images.trueFlow(pair), images.trueMovers(pair.first),
                    cv::Size(first.width, first.height));
  ++report.pairs;
}

void requireFile(const fs::path& file) {
  if (!fs::is_regular_file(file)) throw DatasetError(file.string() + ": is not there, or is not a file");
}

cv::Mat readImage(const fs::path& file) {
  requireFile(file);
  return readColour(file);
}

void requireSize(const fs::path& file, const cv::Size& size, const cv::Size& wanted) {
  if (size == wanted) return;
  throw DatasetError(fmt::format("{}: is {}x{} px, the first image {}x{}", file.string(), size.width,
                                 size.height, wanted.width, wanted.height));
}

}  // namespace

void FlowEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  pairs.describe(fields);
  depth_input.describe(fields);
}

void FlowReport::describe(Figures& figures) {
  figures.name(scene);
  figures.sum("pairs", pairs);
  figures.group(errors);
  figures.figure("ms_per_pair", 1e3 * medianAbsolute(seconds));
  figures.part(seconds);
}

std::string formatTable(const std::vector<FlowReport>& scenes, const FlowReport& overall) {
  std::vector<Column> columns = {{"Pairs", 7, "pairs"}};
  for (const char* group : {"_all", "_static", "_moving"}) {
    for (Column column : {Column{"mean", 11, "epe"},
                          {"median", 8, "epe_median"},
                          {"Fl %", 6, "fl", 1, 1e2},
                          {"dense %", 8, "density", 1, 1e2}}) {
      column.key += group;
      columns.push_back(column);
    }
  }
  columns.push_back({"ms/pair", 10, "ms_per_pair", 1});
  return "End-point error in px of the full image. Fl: of the pixels with flow, those off by over 3 px and "
         "over "
         "5 %. Dense: pixels with flow, of those with truth.\n" +
         fmt::format("{:>32}{:>33}{:>33}\n", "all", "static", "moving") +
         tableOf("Scene", 14, rowsOf(scenes, overall), columns);
}

void validate(const FlowEvaluationOptions& options) {
  validateFields(options);
  validate(options.optical_flow);
  validate(options.depth);
}

FlowReport evaluateFlow(const Tables& tables, Index scene, const FlowEvaluationOptions& options) {
  validate(options);
  const std::vector<ImagePair> pairs = pairsOf(tables, scene, options.pairs);
  requireTruth(tables, options);
  const RadarScene radar = loadRadarScene(tables, scene, {}, options.ego_velocity);
  const SegmentationEvaluationOptions image_options = imageOptionsOf(options);
  SceneImages images(tables, radar, image_options);
  FlowReport report;
  report.scene = tables.scenes[at(scene)].name;
  for (const ImagePair& pair : pairs) evaluatePair(images, pair, options, report);
  return report;
}

FlowReport evaluateFlow(const FlowPairFiles& files, const OpticalFlowParams& params) {
  require(params.initialisation == FlowStart::kNone, fieldsOf(params), {&params.initialisation},
          "a single pair has no flow to start from");
  const std::unique_ptr<OpticalFlow> backend = makeOpticalFlow(params);
  const cv::Mat first = readImage(files.first);
  const cv::Mat second = readImage(files.second);
  requireFile(files.truth);
  const FlowField truth = readFlow(files.truth);
  requireSize(files.second, second.size(), first.size());
  requireSize(files.truth, truth.flow.size(), first.size());
  FlowReport report;
  report.scene = files.first.stem().string();
  report.pairs = 1;
  const cv::Size grid = workingGrid(first.size(), params.working_width);
  const Clock::time_point start = Clock::now();
  FlowField field = backend->compute(first, second);
  field.flow = resizeFlow(field.flow, grid);
  if (!field.valid.empty()) field.valid = resizeNearest(field.valid, grid);
  report.seconds.push_back(secondsSince(start));
  report.errors.add(field, resizeNearest(truth, grid), {}, first.size());
  return report;
}

}  // namespace radar_dot::evaluation
