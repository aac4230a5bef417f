// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_evaluation.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>

#include "report_format.h"
#include "scene_images.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;
using dataset::Tables;

DepthSource sourceOf(const DepthEvaluationOptions& options, bool by_lidar) {
  return {options.depth, options.depth_input, by_lidar};
}

std::filesystem::path folderOfTruth(const std::filesystem::path& dataroot) {
  return dataroot / "ground_truth" / "depth";
}

/// What backend motion looks at, as a vehicle has it.
SegmentationEvaluationOptions imageOptionsOf(const DepthEvaluationOptions& options) {
  SegmentationEvaluationOptions images;
  images.ego_velocity = options.ego_velocity;
  images.optical_flow = options.optical_flow;
  images.optical_flow.flow.working_width = options.depth.working_width;
  images.segmentation.motion_uncertainty = options.motion_uncertainty;
  images.rotation = RotationSource::kRadar;
  return images;
}

std::vector<Index> imagesOf(const Tables& tables, Index scene, const DepthEvaluationOptions& options) {
  const std::vector<Index> readings = tables.readingsOf(scene, options.camera);
  const std::string& name = tables.scenes[at(scene)].name;
  if (readings.empty())
    throw dataset::DatasetError(fmt::format("{}: no readings of {}", name, options.camera));
  const std::size_t wanted = options.max_images > 0 ? options.max_images : readings.size();
  std::vector<Index> images;
  std::size_t missing = 0;
  for (const Index row : readings) {
    const dataset::SampleData& reading = tables.sample_data[at(row)];
    const bool counts =
        reading.is_key_frame &&
        secondsOf(reading) >= secondsOf(tables.sample_data[at(readings.front())]) + options.after;
    if (!counts || images.size() == wanted) continue;
    if (std::filesystem::exists(tables.path(reading)))
      images.push_back(row);
    else
      ++missing;
  }
  if (images.empty()) {
    throw dataset::DatasetError(fmt::format("{}: no keyframe image of {} is under {}", name, options.camera,
                                            tables.dataroot().string()));
  }
  if (missing > 0)
    tables.left_out.add(fmt::format("{} (keyframe images of {})", name, options.camera),
                        fmt::format("not on disk: {} of {}", missing, missing + images.size()));
  return images;
}

}  // namespace

void DepthEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  describeCamera(camera, fields);
  fields.add("max_images", max_images, "Number of images of each scene, the first ones; 0: all");
  fields.add("truth", truth, "What depth is compared with");
  fields.add("after", after, "Images of the first seconds of a scene do not count", "s", {0.0, 1000.0});
  fields.add("static_only", static_only,
             "Independently moving pixels do not count; needs the ground truth of a simulated dataroot");
  describeRadarChannels(radar_channels, fields);
  depth_input.describe(fields);
}

void DepthReport::describe(Figures& figures) {
  figures.name(scene);
  figures.sum("images", images);
  figures.sum("without_truth", without_truth);
  figures.group(errors);
}

void validate(const DepthEvaluationOptions& options) {
  validateFields(options);
  validate(options.depth);
  validate(sourceOf(options, options.truth == DepthTruth::kLidar));
}

DepthTruth truthOf(const DepthEvaluationOptions& options, const std::filesystem::path& dataroot) {
  if (options.truth != DepthTruth::kAuto) return options.truth;
  return std::filesystem::is_directory(folderOfTruth(dataroot)) ? DepthTruth::kGroundTruth
                                                                : DepthTruth::kLidar;
}

DepthReport evaluateDepth(const Tables& tables, Index scene, const DepthEvaluationOptions& options) {
  validate(options);
  const bool by_lidar = truthOf(options, tables.dataroot()) == DepthTruth::kLidar;
  if (const std::filesystem::path folder = folderOfTruth(tables.dataroot());
      !by_lidar && !std::filesystem::is_directory(folder)) {
    throw dataset::DatasetError(
        fmt::format("{}: is not there; exact depth is that of a simulated dataroot; choose truth lidar",
                    folder.string()));
  }
  const std::vector<Index> images = imagesOf(tables, scene, options);
  const RadarScene radar = loadRadarScene(tables, scene, options.radar_channels, options.ego_velocity);
  const SegmentationEvaluationOptions image_options = imageOptionsOf(options);
  SceneImages depths(tables, radar, image_options, sourceOf(options, by_lidar));
  DepthReport report;
  report.scene = tables.scenes[at(scene)].name;
  for (const Index row : images) {
    if (by_lidar && !depths.hasLidar(row)) {
      ++report.without_truth;
      continue;
    }
    depths.keepOnly(row);
    cv::Mat truth = by_lidar ? depths.heldOutDepth(row) : depths.trueDepth(row);
    if (options.static_only) {
      truth = truth.clone();
      truth.setTo(std::numeric_limits<double>::quiet_NaN(), depths.trueMovers(row));
    }
    report.errors.add(depths.depthOf(row), truth, depths.relativeStdOf(row));
    ++report.images;
  }
  return report;
}

std::string formatTable(const std::vector<DepthReport>& scenes, const DepthReport& overall) {
  std::vector<Column> columns = {{"Images", 7, "images"}, {"no truth", 10, "without_truth"}};
  for (const double limit : DepthErrors::kLimits) {
    for (const auto& [title, key] : {std::pair("MAE", "mae"), {"RMSE", "rmse"}, {"cover", "coverage"}})
      columns.push_back({fmt::format("{} {:.0f}", title, limit), 10, fmt::format("{}_{:.0f}", key, limit)});
  }
  columns.push_back({"sigma 50%", 10, "sigma_median"});
  columns.push_back({"sigma 68%", 10, "sigma_68"});
  return tableOf("Scene", 14, rowsOf(scenes, overall), columns);
}

}  // namespace radar_dot::evaluation
