// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_images.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "radar_dot/vision/rigid_motion.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::DatasetError;
using dataset::Index;

DepthSource depthSourceOf(const SegmentationEvaluationOptions& options) {
  DepthConfig depth = options.depth;
  depth.working_width = options.optical_flow.flow.working_width;
  return {depth, options.depth_input};
}

/// A dataroot may hold a part of the images.
bool isOnDisk(const dataset::Tables& tables, const ImagePair& pair) {
  return fs::exists(tables.path(tables.sample_data[at(pair.first)])) &&
         fs::exists(tables.path(tables.sample_data[at(pair.second)]));
}

}  // namespace

std::vector<ImagePair> pairsOf(const dataset::Tables& tables, Index scene, const PairOptions& options) {
  const std::vector<Index> readings = tables.readingsOf(scene, options.camera);
  const std::string& name = tables.scenes[at(scene)].name;
  if (readings.empty())
    throw dataset::DatasetError(fmt::format("{}: no readings of {}", name, options.camera));
  const auto is_key_frame = [&](std::size_t i) { return tables.sample_data[at(readings[i])].is_key_frame; };
  const std::size_t wanted = options.max_pairs > 0 ? options.max_pairs : readings.size();
  std::vector<ImagePair> found;
  std::size_t missing = 0;
  for (std::size_t i = 0; i + 1 < readings.size() && found.size() < wanted; ++i) {
    if (!is_key_frame(i)) continue;
    std::size_t next = i + 1;
    if (options.pairs == ImagePairs::kKeyframes) {
      while (next < readings.size() && !is_key_frame(next)) ++next;
      if (next == readings.size()) break;
    }
    const ImagePair pair{readings[i], readings[next]};
    if (isOnDisk(tables, pair))
      found.push_back(pair);
    else
      ++missing;
  }
  if (found.empty()) {
    throw dataset::DatasetError(fmt::format("{}: no pair of its {} images is under {}", name, options.camera,
                                            tables.dataroot().string()));
  }
  if (missing > 0)
    tables.left_out.add(fmt::format("{} (pairs of {})", name, options.camera),
                        fmt::format("not on disk: {} of {}", missing, missing + found.size()));
  return found;
}

std::optional<ImagePair> previousPair(const dataset::Tables& tables, const ImagePair& pair,
                                      ImagePairs pairs) {
  for (Index row = tables.sample_data[at(pair.first)].previous; row != dataset::kNone;
       row = tables.sample_data[at(row)].previous) {
    if (pairs == ImagePairs::kKeyframes && !tables.sample_data[at(row)].is_key_frame) continue;
    const ImagePair before{row, pair.first};
    return isOnDisk(tables, before) ? std::optional(before) : std::nullopt;
  }
  return std::nullopt;
}

SceneImages::SceneImages(const dataset::Tables& tables, const RadarScene& radar,
                         const SegmentationEvaluationOptions& options)
    : SceneImages(tables, radar, options, depthSourceOf(options)) {}

SceneImages::SceneImages(const dataset::Tables& tables, const RadarScene& radar,
                         const SegmentationEvaluationOptions& options, const DepthSource& depth)
    : SceneDepths(tables, radar, depth),
      radar_(radar),
      options_(options),
      file_source_(fileSourceOf(options.optical_flow.flow.backend)) {
  if (file_source_ == FileSource::kFiles && options.pairs.flow_directory.empty()) {
    throw InvalidParameter({fieldsOf(options.pairs).of(&options.pairs.flow_directory).name},
                           "flow_backend files needs flow_directory, a folder with the flows");
  }
  if (!file_source_) flow_ = makeOpticalFlow(options.optical_flow.flow);
}

void SceneImages::begin(const ImagePair& pair) {
  keepOnly(pair.first);
  if (true_flow_of_ != pair.first) true_flow_of_ = dataset::kNone;
}

Eigen::Isometry3d SceneImages::trueMotion(const ImagePair& pair) const {
  return SceneDepths::trueMotion(secondsOf(reading(pair.first)), secondsOf(reading(pair.second)));
}

const FlowField& SceneImages::trueFlow(const ImagePair& pair) {
  if (true_flow_of_ == pair.first) return true_flow_;
  const std::string prefix = options_.pairs.pairs == ImagePairs::kKeyframes ? "keyframe_" : "";
  FlowField field = readFlow(truthFile(prefix + "flow", pair.first));
  const fs::path occlusion_file = truthFile(prefix + "occlusion", pair.first);
  const cv::Mat occlusion = readGrey(occlusion_file);
  if (occlusion.size() != field.flow.size())
    throw DatasetError(occlusion_file.string() + ": has another size than the flow");
  field.valid.setTo(0, occlusion != 0);
  true_flow_ = resizeNearest(field, sizeOf(pair.first));
  true_flow_of_ = pair.first;
  return true_flow_;
}

cv::Mat SceneImages::trueMovers(Index row) const {
  return resizeNearest(readGrey(truthFile("motion", row)), sizeOf(row));
}

std::optional<MotionDepthInput::Step> SceneImages::stepTo(Index previous, Index row) {
  const double begin = secondsOf(reading(previous)), end = secondsOf(reading(row));
  if (!motion_) {
    motion_.emplace(radar_, options_);
    OpticalFlowParams params = options_.optical_flow.flow;
    if (file_source_) params.backend = OpticalFlowParams().backend;
    params.initialisation = FlowStart::kNone;
    params.forward_backward = true;
    flow_back_ = makeOpticalFlow(params);
  }
  motion_->advanceTo(end);
  std::optional<Eigen::Isometry3d> motion = motion_->between(begin, end, options_.segmentation.max_twist_age);
  const bool true_rotation = options_.rotation == RotationSource::kGroundTruth;
  const bool true_velocity = options_.velocity == VelocitySource::kGroundTruth;
  if (true_velocity && true_rotation) motion = trueMotion({previous, row});
  if (!motion) return std::nullopt;
  if (true_velocity) motion->translation() = trueMotion({previous, row}).translation();
  MotionDepthInput::Step step;
  step.previous_time = begin;
  step.T_current_from_previous = staticPointMotion(mountOf(reading(row)), *motion);
  const MotionUncertainty uncertainty =
      motionUncertainty(options_.segmentation.motion_uncertainty, motion_->covariance(), true_rotation);
  step.motion_covariance =
      cameraCovariance(mountOf(reading(row)), baseMotionCovariance(uncertainty, end - begin));
  const FlowField field = flow_back_->compute(imageOf(row), imageOf(previous));
  step.flow_back = field.flow;
  step.fb_error = field.fb_error;
  return step;
}

FlowField SceneImages::flowOf(const ImagePair& pair, const Eigen::Isometry3d& T_first_from_second) {
  const cv::Size size = sizeOf(pair.first);
  if (file_source_ == FileSource::kGroundTruth) return trueFlow(pair);
  FlowField field;
  if (file_source_) {
    field = readFlow(fs::path(options_.pairs.flow_directory) / pngName(pair.first));
    // Flow of a network is smooth within objects: better interpolated.
    return {resizeFlow(field.flow, size), resizeNearest(field.valid, size)};
  }
  cv::Mat expected;
  if (options_.optical_flow.flow.initialisation == FlowStart::kExpected) {
    expected =
        expectedFlow(gridOf(pair.first), staticPointMotion(mountOf(reading(pair.first)), T_first_from_second),
                     depthOf(pair.first));
  }
  field = flow_->compute(imageOf(pair.first), imageOf(pair.second), expected);
  if (field.flow.size() == size) return field;
  if (!field.valid.empty()) field.valid = resizeNearest(field.valid, size);
  if (!field.fb_error.empty())
    field.fb_error =
        resizeNearest(field.fb_error, size) * (static_cast<double>(size.width) / field.flow.cols);
  if (!field.backward.empty()) field.backward = resizeFlow(field.backward, size);
  field.flow = resizeFlow(field.flow, size);
  return field;
}

}  // namespace radar_dot::evaluation
