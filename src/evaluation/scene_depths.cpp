// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_depths.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "noisy_depth.h"
#include "radar_dot/dataset/point_files.h"
#include "segmentation_images.h"
#include "sweep_velocities.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::DatasetError;
using dataset::Index;

/// Every second point of each beam, shifted by one from beam to beam: both halves see every beam and every
/// direction.
class Halves {
 public:
  /// Of the points in the order of the file. @param ring  number of the beam
  bool isHeldOut(float ring) {
    const bool known = ring >= 0.0F && ring < static_cast<float>(counts_.size());
    const std::size_t beam = known ? static_cast<std::size_t>(ring) : 0;
    return (beam + counts_[beam]++) % 2 == 1;
  }

 private:
  std::array<std::size_t, 256> counts_{};
};

}  // namespace

std::string pngNameOf(const dataset::Tables& tables, Index row) {
  return tables.path(tables.sample_data[at(row)]).stem().string() + ".png";
}

CameraIntrinsics cameraOf(const dataset::Tables& tables, Index row) {
  const dataset::SampleData& reading = tables.sample_data[at(row)];
  const dataset::CalibratedSensor& sensor = tables.calibrated_sensors[at(reading.calibrated_sensor)];
  if (!sensor.camera_matrix) {
    throw DatasetError(fmt::format("calibrated_sensor.json: that of {} has no camera_intrinsic",
                                   tables.path(reading).string()));
  }
  try {
    return CameraIntrinsics::fromMatrix(*sensor.camera_matrix, reading.width, reading.height);
  } catch (const std::invalid_argument& error) {
    throw DatasetError(fmt::format("{}: {}", tables.path(reading).string(), error.what()));
  }
}

void validate(const DepthSource& source) {
  if (fileSourceOf(source.config.depth.backend) != FileSource::kFiles ||
      !source.input.depth_directory.empty())
    return;
  throw InvalidParameter({fieldsOf(source.input).of(&source.input.depth_directory).name},
                         "depth_backend files needs depth_directory, a folder with the depths");
}

SceneDepths::SceneDepths(const dataset::Tables& tables, const RadarScene& radar, const DepthSource& source)
    : tables_(tables),
      radar_(radar),
      source_(source),
      file_source_(fileSourceOf(source.config.depth.backend)) {
  validate(source_);
  if (!file_source_) depth_ = makeDepthEstimator(source_.config.depth);
}

void SceneDepths::keepOnly(Index row) {
  for (std::map<Index, cv::Mat>* kept : {&pictures_, &depths_, &stds_, &true_depths_}) {
    for (auto entry = kept->begin(); entry != kept->end();)
      entry = entry->first == row ? std::next(entry) : kept->erase(entry);
  }
}

fs::path SceneDepths::truthFile(const std::string& folder, Index row) const {
  return tables_.dataroot() / "ground_truth" / folder / pngName(row);
}

CameraIntrinsics SceneDepths::gridOf(Index row) const {
  const cv::Size grid = sizeOf(row);
  return cameraOf(tables_, row).scaledTo(grid.width, grid.height);
}

cv::Size SceneDepths::sizeOf(Index row) const {
  return workingGrid({reading(row).width, reading(row).height}, source_.config.working_width);
}

const cv::Mat& SceneDepths::imageOf(Index row) {
  cv::Mat& image = pictures_[row];
  if (image.empty()) {
    const fs::path path = tables_.path(reading(row));
    image = readColour(path);
    const cv::Size told(reading(row).width, reading(row).height);
    if (image.size() != told)
      throw DatasetError(fmt::format("{}: has {}x{} px, not the {}x{} of sample_data.json", path.string(),
                                     image.cols, image.rows, told.width, told.height));
  }
  return image;
}

bool SceneDepths::seesRadar(const std::string& channel) const {
  const std::vector<std::string>& chosen = source_.input.depth_radar_channels;
  if (chosen.empty()) return !depth_->needs().trained_radars_only || channel == "RADAR_FRONT";
  return std::find(chosen.begin(), chosen.end(), channel) != chosen.end();
}

/// All that networks were trained with; else static ones: what moves is at another place in the other image,
/// and ghosts of it cover the road.
std::vector<Eigen::Vector3f> SceneDepths::radarPoints(double time) {
  const bool only_static = !depth_->needs().trained_radars_only;
  if (only_static && labels_.empty()) labels_ = returnLabels(radar_);
  std::vector<Eigen::Vector3f> points;
  for (const LoadedRadar& radar : radar_.radars) {
    if (!seesRadar(radar.channel)) continue;
    const std::optional<std::size_t> nearest = nearestScan(radar, time, source_.config.radar_max_age);
    if (!nearest) continue;
    const LoadedScan& scan = radar.scans[*nearest];
    const Eigen::Isometry3d T_base_from_sensor = trueMotion(time, scan.time) * radar.T_base_from_sensor;
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      if (only_static) {
        const std::vector<ReturnLabel>& labels = labels_[radar.number][*nearest];
        if (i >= labels.size() || labels[i] != ReturnLabel::kStatic) continue;
      }
      points.push_back(positionOf(scan.returns[i], T_base_from_sensor));
    }
  }
  return points;
}

const dataset::SampleData* SceneDepths::lidarOf(Index row) const {
  const double time = secondsOf(reading(row));
  const Index scene = tables_.samples[at(reading(row).sample)].scene;
  const dataset::SampleData* nearest = nullptr;
  double distance = source_.config.lidar_max_age;
  for (const Index candidate : tables_.readingsOf(scene, "LIDAR_TOP")) {
    const dataset::SampleData& sweep = reading(candidate);
    const double apart = std::abs(secondsOf(sweep) - time);
    if (apart > distance || !fs::exists(tables_.path(sweep))) continue;
    nearest = &sweep;
    distance = apart;
  }
  return nearest;
}

std::vector<Eigen::Vector3f> SceneDepths::lidarPoints(Index row, LidarPart part) const {
  const dataset::SampleData* sweep = lidarOf(row);
  if (sweep == nullptr) {
    throw DatasetError(fmt::format("{}: no LIDAR_TOP sweep on disk within {} s of the image",
                                   tables_.path(reading(row)).string(), source_.config.lidar_max_age));
  }
  // The sweep as seen from the vehicle at the time of the image.
  const Eigen::Isometry3f T_base_from_lidar =
      (trueMotion(secondsOf(reading(row)), secondsOf(*sweep)) * mountOf(*sweep)).cast<float>();
  const PointCloud cloud = dataset::readLidarBin(tables_.path(*sweep));
  const PointField* ring_field = findField(cloud.fields, "ring");
  Halves halves;
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    const std::uint8_t* record = cloud.data.data() + i * cloud.point_step;
    Eigen::Vector3f point;
    std::memcpy(point.data(), record, sizeof(float) * 3);
    float ring = 0.0F;
    if (ring_field != nullptr) std::memcpy(&ring, record + ring_field->offset, sizeof(float));
    if (part != LidarPart::kAll && halves.isHeldOut(ring) != (part == LidarPart::kHeldOut)) continue;
    points.emplace_back(T_base_from_lidar * point);
  }
  return points;
}

/// Depth of an image by an estimator that sees all images in the order of time: those since the last one
/// first.
void SceneDepths::followTo(Index row) {
  std::vector<Index> images;  // backward
  Index image = row;
  for (; image != dataset::kNone && image != followed_ && fs::exists(tables_.path(reading(image)));
       image = reading(image).previous)
    images.push_back(image);
  Index previous = image == followed_ ? followed_ : dataset::kNone;
  for (auto next = images.rbegin(); next != images.rend(); ++next) {
    DepthInput input = inputOf(*next);
    if (previous != dataset::kNone) input.step = stepTo(previous, *next);
    const cv::Mat depth = depth_->estimate(input);
    if (*next == row) {
      depths_[row] = depth;
      stds_[row] = depth_->relativeStd(input, depth);
    }
    pictures_.erase(previous);
    previous = followed_ = *next;
  }
}

cv::Mat SceneDepths::computeDepth(Index row) {
  if (!file_source_) return depth_->estimate(inputOf(row));
  switch (*file_source_) {
    case FileSource::kGroundTruth: return trueDepth(row);
    case FileSource::kNoisy:
      return noisyDepth(trueDepth(row), {}, static_cast<std::uint64_t>(reading(row).timestamp_us));
    case FileSource::kFiles: break;
  }
  return resizeNearest(readDepth(fs::path(source_.input.depth_directory) / pngName(row)), sizeOf(row));
}

DepthInput SceneDepths::inputOf(Index row) {
  DepthInput input;
  input.camera = gridOf(row);
  input.pixel_scale = static_cast<double>(reading(row).width) / input.camera.width;
  input.time = secondsOf(reading(row));
  input.T_base_from_camera = mountOf(reading(row));
  const DepthNeeds needs = depth_->needs();
  if (needs.image) input.image = imageOf(row);
  if (needs.lidar)
    input.lidar_points = lidarPoints(row, source_.half_of_lidar ? LidarPart::kSeen : LidarPart::kAll);
  if (needs.radar) input.radar_points = radarPoints(secondsOf(reading(row)));
  return input;
}

cv::Mat SceneDepths::relativeStdOf(Index row) {
  const cv::Mat& depth = depthOf(row);
  if (follows()) return stds_[row];
  if (!file_source_) return depth_->relativeStd(inputOf(row), depth);
  switch (*file_source_) {
    case FileSource::kGroundTruth: return constantStd(depth, kTrueDepthStd);
    case FileSource::kNoisy: return noisyDepthStd(trueDepth(row), depth, {});
    case FileSource::kFiles: break;
  }
  return constantStd(depth, source_.config.depth.relative_std);
}

const cv::Mat& SceneDepths::depthOf(Index row) {
  cv::Mat& depth = depths_[row];
  if (depth.empty() && follows()) {
    followTo(row);
  } else if (depth.empty()) {
    depth = computeDepth(row);
  }
  return depth;
}

const cv::Mat& SceneDepths::trueDepth(Index row) {
  cv::Mat& depth = true_depths_[row];
  if (depth.empty()) depth = resizeNearest(readDepth(truthFile("depth", row)), sizeOf(row));
  return depth;
}

cv::Mat SceneDepths::heldOutDepth(Index row) const {
  return projectedDepth(lidarPoints(row, LidarPart::kHeldOut), gridOf(row), mountOf(reading(row)),
                        source_.config.depth.max_depth);
}

}  // namespace radar_dot::evaluation
