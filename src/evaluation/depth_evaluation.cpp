// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_evaluation.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "report_format.h"
#include "scene_depths.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;
using dataset::Tables;

constexpr double kWithinSigma = 0.6827;  // share of normal errors within 1 sigma

std::vector<Index> imagesOf(const Tables& tables, Index scene, const DepthEvaluationOptions& options) {
  const std::vector<Index> readings = tables.readingsOf(scene, options.camera);
  const std::string& name = tables.scenes[at(scene)].name;
  if (readings.empty()) throw NoImages(fmt::format("{}: no readings of {}", name, options.camera));
  std::vector<Index> images;
  for (const Index row : readings) {
    const dataset::SampleData& reading = tables.sample_data[at(row)];
    if (reading.is_key_frame && std::filesystem::exists(tables.path(reading))) images.push_back(row);
  }
  if (images.empty()) {
    throw NoImages(fmt::format("{}: no keyframe image of {} is under {}", name, options.camera,
                               tables.dataroot().string()));
  }
  if (options.max_images > 0 && images.size() > options.max_images) images.resize(options.max_images);
  return images;
}

Figures figuresOf(const DepthReport& report) {
  Figures figures;
  for (std::size_t i = 0; i < report.errors.within.size(); ++i) {
    const DepthErrors::Sums& sums = report.errors.within[i];
    const double limit = DepthErrors::kLimits[i];
    figures.emplace_back(fmt::format("mae_{:.0f}", limit), sums.meanAbsoluteError());
    figures.emplace_back(fmt::format("rmse_{:.0f}", limit), sums.rootMeanSquaredError());
    figures.emplace_back(fmt::format("coverage_{:.0f}", limit), sums.coverage());
  }
  figures.emplace_back("sigma_median", report.errors.normalised.quantile(0.5));
  figures.emplace_back("sigma_68", report.errors.normalised.quantile(kWithinSigma));
  return figures;
}

Counts countsOf(const DepthReport& report) {
  Counts counts = {{"images", report.images}, {"without_truth", report.without_truth}};
  for (std::size_t i = 0; i < report.errors.within.size(); ++i) {
    const double limit = DepthErrors::kLimits[i];
    counts.emplace_back(fmt::format("true_pixels_{:.0f}", limit), report.errors.within[i].true_pixels);
    counts.emplace_back(fmt::format("compared_{:.0f}", limit), report.errors.within[i].compared);
  }
  return counts;
}

}  // namespace

void DepthEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  describeCamera(camera, fields);
  fields.add("max_images", max_images, "Number of images of each scene, the first ones; 0: all");
  fields.add("truth", truth, "What depth is compared with");
  describeRadarChannels(radar_channels, fields);
  depth_input.describe(fields);
}

DepthReport& DepthReport::operator+=(const DepthReport& other) {
  images += other.images;
  without_truth += other.without_truth;
  errors += other.errors;
  return *this;
}

DepthReport evaluateDepth(const Tables& tables, Index scene, const DepthEvaluationOptions& options) {
  validateFields(options);
  validate(options.depth);
  const bool by_lidar = options.truth == DepthTruth::kLidar;
  const DepthSource source{options.depth.depth, options.depth.working_width, options.depth_input, by_lidar};
  validate(source);
  const std::vector<Index> images = imagesOf(tables, scene, options);
  const RadarScene radar = loadRadarScene(tables, scene, options.radar_channels, options.ego_velocity);
  SceneDepths depths(tables, radar, source);
  DepthReport report;
  report.scene = tables.scenes[at(scene)].name;
  for (const Index row : images) {
    if (by_lidar && !depths.hasLidar(row)) {
      ++report.without_truth;
      continue;
    }
    depths.keepOnly(row);
    report.errors.add(depths.depthOf(row), by_lidar ? depths.heldOutDepth(row) : depths.trueDepth(row),
                      depths.relativeStdOf(row));
    ++report.images;
  }
  return report;
}

std::string formatTable(const std::vector<DepthReport>& scenes, const DepthReport& overall) {
  std::string table = fmt::format("{:<14}{:>7}{:>10}", "Scene", "Images", "no truth");
  for (const double limit : DepthErrors::kLimits) {
    table += fmt::format("{:>10}{:>10}{:>10}", fmt::format("MAE {:.0f}", limit),
                         fmt::format("RMSE {:.0f}", limit), fmt::format("cover {:.0f}", limit));
  }
  table += fmt::format("{:>10}{:>10}\n", "sigma 50%", "sigma 68%");
  const auto row = [&table](const DepthReport& report, const std::string& name) {
    table += fmt::format("{:<14}{:>7}{:>10}", name, report.images, report.without_truth);
    for (const auto& [key, value] : figuresOf(report)) table += fmt::format("{:>10}", figure(value));
    table += "\n";
  };
  for (const DepthReport& scene : scenes) row(scene, scene.scene);
  row(overall, "Overall");
  return table;
}

std::string formatJson(const std::vector<DepthReport>& scenes, const DepthReport& overall) {
  return jsonOf(scenes, overall, figuresOf, countsOf);
}

std::string formatCsv(const std::vector<DepthReport>& scenes, const DepthReport& overall) {
  return csvOf(scenes, overall, figuresOf, countsOf);
}

}  // namespace radar_dot::evaluation
