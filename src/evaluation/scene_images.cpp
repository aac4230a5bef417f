// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_images.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>

#include "radar_dot/dataset/point_files.h"
#include "radar_dot/evaluation/noisy_depth.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::DatasetError;
using dataset::Index;

bool isFromFiles(const std::string& backend) {
  return backend == "ground_truth" || backend == "noisy" || backend == "files";
}

/// Keeps the entry of one image.
template <typename Entries>
void keepOnly(Entries& entries, Index row) {
  for (auto entry = entries.begin(); entry != entries.end();)
    entry = entry->first == row ? std::next(entry) : entries.erase(entry);
}

}  // namespace

SceneImages::SceneImages(const dataset::Tables& tables, const RadarScene& radar,
                         const SegmentationEvaluationOptions& options)
    : tables_(tables), radar_(radar), options_(options) {
  if (!isFromFiles(options.flow)) {
    OpticalFlowParams params = options.optical_flow;
    params.backend = options.flow;
    params.working_width = options.working_width;
    flow_ = makeOpticalFlow(params);
  }
  if (!isFromFiles(options.depth)) {
    DepthParams params = options.depth_params;
    params.backend = options.depth;
    depth_ = makeDepthEstimator(params);
  }
}

void SceneImages::begin(const ImagePair& pair) {
  for (std::map<Index, cv::Mat>* kept : {&pictures_, &depths_, &true_depths_}) keepOnly(*kept, pair.first);
  keepOnly(true_flows_, pair.first);
}

Eigen::Isometry3d SceneImages::trueMotion(const ImagePair& pair) const {
  return radar_.truth.at(secondsOf(reading(pair.first))).inverse() *
         radar_.truth.at(secondsOf(reading(pair.second)));
}

std::string SceneImages::pngName(Index row) const {
  return tables_.path(reading(row)).stem().string() + ".png";
}

fs::path SceneImages::truthFile(const std::string& folder, Index row) const {
  return tables_.dataroot() / "ground_truth" / folder / pngName(row);
}

CameraIntrinsics SceneImages::cameraOf(Index row) const {
  const dataset::CalibratedSensor& sensor = tables_.calibrated_sensors[at(reading(row).calibrated_sensor)];
  if (!sensor.camera_matrix) {
    throw DatasetError(fmt::format("calibrated_sensor.json: {} has no camera_intrinsic", options_.channel));
  }
  try {
    return CameraIntrinsics::fromMatrix(*sensor.camera_matrix, reading(row).width, reading(row).height);
  } catch (const std::invalid_argument& error) {
    throw DatasetError(fmt::format("{}: {}", tables_.path(reading(row)).string(), error.what()));
  }
}

CameraIntrinsics SceneImages::gridOf(Index row) const {
  const CameraIntrinsics camera = cameraOf(row);
  const cv::Size grid = workingGrid({camera.width, camera.height}, options_.working_width);
  return camera.scaledTo(grid.width, grid.height);
}

cv::Size SceneImages::sizeOf(Index row) const {
  return workingGrid({reading(row).width, reading(row).height}, options_.working_width);
}

const cv::Mat& SceneImages::pictureOf(Index row) {
  cv::Mat& image = pictures_[row];
  if (image.empty()) {
    const fs::path path = tables_.path(reading(row));
    image = cv::imread(path.string(), cv::IMREAD_COLOR);
    if (image.empty()) throw DatasetError(fmt::format("{}: cannot be read as an image", path.string()));
  }
  return image;
}

std::vector<Eigen::Vector3f> SceneImages::radarPoints(double time) const {
  std::vector<Eigen::Vector3f> points;
  for (const LoadedRadar& radar : radar_.radars) {
    const std::optional<std::size_t> nearest = nearestScan(radar, time, kRadarReach);
    if (!nearest) continue;
    for (const DopplerReturn& seen : radar.scans[*nearest].returns)
      points.push_back(positionOf(seen, radar.T_base_from_sensor));
  }
  return points;
}

std::vector<Eigen::Vector3f> SceneImages::lidarPoints(const dataset::SampleData& image) const {
  const double time = secondsOf(image);
  const Index scene = tables_.samples[at(image.sample)].scene;
  const dataset::SampleData* nearest = nullptr;
  for (const Index row : tables_.readingsOf(scene, "LIDAR_TOP")) {
    const dataset::SampleData& sweep = reading(row);
    if (nearest == nullptr || std::abs(secondsOf(sweep) - time) < std::abs(secondsOf(*nearest) - time))
      nearest = &sweep;
  }
  if (nearest == nullptr || std::abs(secondsOf(*nearest) - time) > kRadarReach) {
    throw DatasetError(fmt::format("{}: no LIDAR_TOP sweep within {} s of the image, as depth 'lidar' needs",
                                   tables_.path(image).string(), kRadarReach));
  }
  // The sweep as seen from the vehicle at the time of the image.
  const Eigen::Isometry3d T_base_from_lidar =
      radar_.truth.at(time).inverse() * radar_.truth.at(secondsOf(*nearest)) * mountOf(*nearest);
  const PointCloud cloud = dataset::readLidarBin(tables_.path(*nearest));
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    Eigen::Vector3f point;
    std::memcpy(point.data(), cloud.data.data() + i * cloud.point_step, sizeof(float) * 3);
    points.emplace_back(T_base_from_lidar.cast<float>() * point);
  }
  return points;
}

cv::Mat SceneImages::computeDepth(Index row) {
  if (options_.depth == "files")
    return resizeNearest(readDepth(fs::path(options_.depth_directory) / pngName(row)), sizeOf(row));
  if (options_.depth == "ground_truth") return trueDepth(row);
  if (options_.depth == "noisy")
    return noisyDepth(trueDepth(row), {}, static_cast<std::uint64_t>(reading(row).timestamp_us));
  DepthInput input;
  input.image = pictureOf(row);
  input.camera = gridOf(row);
  input.T_base_from_camera = mountOf(reading(row));
  if (options_.depth == "lidar") {
    input.lidar_points = lidarPoints(reading(row));
  } else {
    input.radar_points = radarPoints(secondsOf(reading(row)));
  }
  return depth_->estimate(input);
}

const cv::Mat& SceneImages::depthOf(Index row) {
  cv::Mat& depth = depths_[row];
  if (depth.empty()) depth = computeDepth(row);
  return depth;
}

const cv::Mat& SceneImages::trueDepth(Index row) {
  cv::Mat& depth = true_depths_[row];
  if (depth.empty()) depth = resizeNearest(readDepth(truthFile("depth", row)), sizeOf(row));
  return depth;
}

const FlowField& SceneImages::trueFlow(const ImagePair& pair) {
  FlowField& kept = true_flows_[pair.first];
  if (!kept.flow.empty()) return kept;
  const std::string prefix = options_.pairs == "keyframes" ? "keyframe_" : "";
  FlowField field = readFlow(truthFile(prefix + "flow", pair.first));
  const fs::path occlusion_file = truthFile(prefix + "occlusion", pair.first);
  const cv::Mat occlusion = readGrey(occlusion_file);
  if (occlusion.size() != field.flow.size())
    throw DatasetError(occlusion_file.string() + ": has another size than the flow");
  field.valid.setTo(0, occlusion != 0);
  kept = resizeNearest(field, sizeOf(pair.first));
  return kept;
}

FlowField SceneImages::flowOf(const ImagePair& pair, const MotionInput& input) {
  const cv::Size size(input.camera.width, input.camera.height);
  if (options_.flow == "ground_truth") return trueFlow(pair);
  FlowField field;
  if (options_.flow == "files") {
    field = readFlow(fs::path(options_.flow_directory) / pngName(pair.first));
    // Flow of a network is smooth within objects: better interpolated.
    return {resizeFlow(field.flow, size), resizeNearest(field.valid, size)};
  }
  cv::Mat expected;
  if (options_.optical_flow.initialisation == "expected")
    expected = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  field = flow_->compute(pictureOf(pair.first), pictureOf(pair.second), expected);
  if (field.flow.size() == size) return field;
  if (!field.valid.empty()) field.valid = resizeNearest(field.valid, size);
  field.flow = resizeFlow(field.flow, size);
  return field;
}

}  // namespace radar_dot::evaluation
