// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/segmentation_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/replace_file.h"
#include "creeping_actors.h"
#include "radar_dot/vision/rigid_motion.h"
#include "radar_scene.h"
#include "scene_images.h"
#include "scene_motion.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::Index;
using dataset::Tables;

constexpr std::uint8_t kCounts = 0;  // values of the ignore image
constexpr std::uint8_t kIgnored = 255;

/// As of the nodelet. The ground is refined where the depth shows it.
MaskPipelineParams pipelineParams(const SegmentationEvaluationOptions& options) {
  MaskPipelineParams params = options.segmentation;
  params.refine_ground = params.refine_ground && options.depth.depth.backend == kRadarGroundBackend;
  return params;
}

/// What is annotated for other cameras alone says nothing of what moves in this one.
/// @throws DatasetError
void requireTruth(const Tables& tables, const std::vector<const dataset::InstanceMask*>& masks,
                  const std::string& camera) {
  std::set<std::string> cameras;
  for (const dataset::InstanceMask* mask : masks)
    cameras.insert(tables.channelOf(tables.sample_data[at(tables.findReading(mask->sample_data_token))]));
  if (!cameras.empty() && cameras.count(camera) == 0)
    throw dataset::DatasetError(fmt::format("{}/nuinsseg.json: has no mask of {}, only of {}",
                                            tables.version(), camera, fmt::join(cameras, ", ")));
}

/// Runs one scene.
class SceneRunner {
 public:
  SceneRunner(const Tables& tables, Index scene, const SegmentationEvaluationOptions& options)
      : tables_(tables),
        options_(options),
        radar_(loadRadarScene(tables, scene, options.radar_channels, options.ego_velocity)),
        images_(tables, radar_, options),
        motion_(radar_, options),
        pipeline_(pipelineParams(options)) {
    if (options.min_true_residual > 0.0) creeping_.emplace(tables, scene);
  }

  void evaluate(const ImagePair& pair, const cv::Mat& truth, const cv::Mat& people,
                SegmentationReport& report);

 private:
  std::optional<Eigen::Isometry3d> motionOf(const ImagePair& pair, MaskPair& input, Mean& velocity_error);
  std::optional<MaskPair> prepare(const ImagePair& pair, Mean& velocity_error, FlowField& backward);
  std::optional<MaskOutcome> process(const ImagePair& pair, SegmentationReport& report);
  const DynamicSegmentationConfig& segmentation() const { return options_.segmentation; }
  void remember(const MaskPair& pair, const cv::Mat& mask);
  cv::Mat ignoredOf(const ImagePair& pair, const CameraIntrinsics& grid, double pixel_scale);

  const Tables& tables_;
  const SegmentationEvaluationOptions& options_;
  RadarScene radar_;
  SceneImages images_;
  SceneMotion motion_;
  MaskPipeline pipeline_;
  std::optional<CreepingActors> creeping_;  // with min_true_residual
  ImagePair latest_;                        // that the pipeline has seen
};

/// Keeps the mask of a pair for the velocities after it. It lives at the time of the pair's first image.
void SceneRunner::remember(const MaskPair& pair, const cv::Mat& mask) {
  if (!options_.mask_to_velocity) return;
  motion_.setMask({pair.first_time, mask, pair.camera, pair.T_base_from_camera.inverse()});
}

/// Motion and returns as a vehicle knows them at the second image; none where the velocity is not known.
std::optional<Eigen::Isometry3d> SceneRunner::motionOf(const ImagePair& pair, MaskPair& input,
                                                       Mean& velocity_error) {
  const double begin = input.first_time, end = input.second_time;
  const bool true_velocity = options_.velocity == VelocitySource::kGroundTruth;
  const bool true_rotation = options_.rotation == RotationSource::kGroundTruth;
  const bool at_start = options_.velocity == VelocitySource::kRadarStart;
  const Eigen::Isometry3d truth = images_.trueMotion(pair);
  motion_.advanceTo(end);
  input.dynamic_points = motion_.pointsAt(ReturnLabel::kDynamic, begin);
  input.static_points = motion_.pointsAt(ReturnLabel::kStatic, begin);
  if (true_velocity && true_rotation) return truth;
  const std::optional<StampedTwist> twist = motion_.mean(begin, at_start ? begin : end);
  if (!twist) return std::nullopt;
  if (!true_velocity) {
    const Eigen::Vector3d true_mean = radar_.truth.meanVelocity(begin, end);
    velocity_error.add((twist->linear - true_mean).head<2>().norm());
    input.motion_uncertainty =
        motionUncertainty(segmentation().motion_uncertainty, motion_.covariance(), true_rotation);
  }
  if (at_start) {
    return true_rotation ? baseMotionWithRotation(twist->linear, truth.linear(), end - begin)
                         : baseMotion(twist->linear, twist->angular, end - begin);
  }
  std::optional<Eigen::Isometry3d> motion = motion_.between(begin, end, segmentation().max_twist_age);
  if (motion && true_velocity) motion->translation() = truth.translation();
  return motion;
}

/// Movers whose true flow hardly differs from that of a static world, or that the other image does not show.
cv::Mat SceneRunner::ignoredOf(const ImagePair& pair, const CameraIntrinsics& grid, double pixel_scale) {
  const cv::Size size(grid.width, grid.height);
  const FlowField& flow = images_.trueFlow(pair);
  const Eigen::Isometry3d T_current_from_previous =
      staticPointMotion(images_.mountOf(images_.reading(pair.first)), images_.trueMotion(pair));
  const cv::Mat expected = expectedFlow(grid, T_current_from_previous, images_.trueDepth(pair.first));
  cv::Mat ignored(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const cv::Vec2f difference = flow.flow.at<cv::Vec2f>(row, column) - expected.at<cv::Vec2f>(row, column);
      const double residual =
          pixel_scale * std::hypot(static_cast<double>(difference[0]), static_cast<double>(difference[1]));
      const bool counts =
          flow.valid.at<std::uint8_t>(row, column) != 0 && residual >= options_.min_true_residual;
      ignored.at<std::uint8_t>(row, column) = counts ? kCounts : kIgnored;
    }
  }
  return ignored;
}

/// @param ignored   of movers: kIgnored where they do not count; empty: all count
/// @param creeping  255 where what is not called moving does not count; empty: all counts
void count(const cv::Mat& mask, const cv::Mat& truth, const cv::Mat& ignored, const cv::Mat& creeping,
           Confusion& pixels) {
  for (int row = 0; row < truth.rows; ++row) {
    const auto* predicted = mask.ptr<std::uint8_t>(row);
    const auto* actual = truth.ptr<std::uint8_t>(row);
    const auto* ignore = ignored.empty() ? nullptr : ignored.ptr<std::uint8_t>(row);
    const auto* creeps = creeping.empty() ? nullptr : creeping.ptr<std::uint8_t>(row);
    for (int column = 0; column < truth.cols; ++column) {
      const bool moves = actual[column] != 0;
      if (moves && ignore != nullptr && ignore[column] != kCounts) continue;
      if (!moves && creeps != nullptr && creeps[column] != 0) continue;
      pixels.add(predicted[column] != 0, moves);
    }
  }
}

std::vector<const dataset::InstanceMask*> peopleIn(
    const std::vector<const dataset::InstanceMask*>& instances) {
  std::vector<const dataset::InstanceMask*> people;
  std::copy_if(instances.begin(), instances.end(), std::back_inserter(people),
               [](const auto* instance) { return instance->category_name.rfind("human.", 0) == 0; });
  return people;
}

/// None where the velocity is not known.
std::optional<MaskPair> SceneRunner::prepare(const ImagePair& pair, Mean& velocity_error,
                                             FlowField& backward) {
  images_.begin(pair);
  const dataset::SampleData& first = images_.reading(pair.first);
  MaskPair input;
  input.first_time = secondsOf(first);
  input.second_time = secondsOf(images_.reading(pair.second));
  input.camera = images_.gridOf(pair.first);
  input.pixel_scale = static_cast<double>(first.width) / input.camera.width;
  input.T_base_from_camera = images_.mountOf(first);
  input.motion_uncertainty = segmentation().motion_uncertainty;
  const std::optional<Eigen::Isometry3d> motion = motionOf(pair, input, velocity_error);
  if (!motion) return std::nullopt;
  input.T_first_from_second = *motion;
  input.depth = images_.depthOf(pair.first);
  input.next_depth = images_.depthOf(pair.second);
  if (segmentation().usesDepthUncertainty()) input.depth_std = images_.relativeStdOf(pair.first);
  input.flow = images_.flowOf(pair, *motion);
  if (segmentation().usesBackwardFlow()) backward = backwardField(input.flow, options_.optical_flow.flow);
  return input;
}

std::optional<MaskOutcome> SceneRunner::process(const ImagePair& pair, SegmentationReport& report) {
  FlowField backward;
  const std::optional<MaskPair> input = prepare(pair, report.velocity_error, backward);
  latest_ = pair;
  if (!input) return std::nullopt;
  const auto start = std::chrono::steady_clock::now();
  MaskOutcome outcome = pipeline_.process(*input);
  report.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!backward.flow.empty()) pipeline_.addBackward(input->second_time, input->first_time, backward);
  remember(*input, outcome.result.mask);
  return outcome;
}

void SceneRunner::evaluate(const ImagePair& pair, const cv::Mat& truth, const cv::Mat& people,
                           SegmentationReport& report) {
  // What a vehicle has seen since the pair before, or from the begin on.
  std::vector<ImagePair> unseen;
  for (std::optional<ImagePair> before = pair; segmentation().usesBackwardFlow();) {
    before = previousPair(tables_, *before, options_.pairs.pairs);
    if (!before || (latest_.first == before->first && latest_.second == before->second)) break;
    unseen.push_back(*before);
  }
  SegmentationReport not_counted;
  while (!unseen.empty()) {
    process(unseen.back(), not_counted);
    unseen.pop_back();
  }
  const CameraIntrinsics grid = images_.gridOf(pair.first);
  ++report.frames;
  const std::optional<MaskOutcome> outcome = process(pair, report);
  if (!outcome) ++report.without_motion;
  cv::Mat mask = outcome ? outcome->result.mask : cv::Mat::zeros(grid.height, grid.width, CV_8UC1);
  cv::Mat ignored, creeping;
  if (options_.min_true_residual > 0.0) {
    const double pixel_scale = static_cast<double>(images_.reading(pair.first).width) / grid.width;
    ignored = resizeNearest(ignoredOf(pair, grid, pixel_scale), truth.size());
    creeping = resizeNearest(creeping_->shownBy(pair.first), truth.size());
  }
  mask = resizeNearest(mask, truth.size());
  Confusion of_pair;
  count(mask, truth, ignored, creeping, of_pair);
  report.addPair(of_pair);
  if (!people.empty()) {
    Confusion of_people;
    count(mask, people, ignored, {}, of_people);
    report.people_found += of_people.true_positives;
    report.people_pixels += of_people.true_positives + of_people.false_negatives;
  }
  if (!options_.mask_directory.empty()) {
    const fs::path file = fs::path(options_.mask_directory) / images_.pngName(pair.first);
    std::vector<std::uint8_t> png;
    cv::imencode(".png", mask, png);
    replaceFile(file.string(), std::string(png.begin(), png.end()));
  }
}

}  // namespace

void SegmentationEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  pairs.describe(fields);
  depth_input.describe(fields);
  describeRadarChannels(radar_channels, fields);
  fields.add("velocity", velocity, "Velocity of the vehicle between the images of a pair");
  fields.add("rotation", rotation, "Rotation of the vehicle between the images of a pair");
  fields.add("min_true_residual", min_true_residual,
             "Movers whose true flow differs less from that of a static world, or that the second image does "
             "not show, do not count, nor do road users that creep too slowly to be annotated as moving; "
             "needs the ground truth of a simulated dataroot; 0: all count",
             "px", {0.0, 10000.0});
  fields.add("mask_to_velocity", mask_to_velocity,
             "Returns in the latest mask are dynamic in the next velocity estimates");
  fields.add("save_masks", mask_directory,
             "Folder to which every mask is written as PNG; with --ablation one in it for each step");
}

void validate(const SegmentationEvaluationOptions& options) {
  validateFields(options);
  validate(options.ego_velocity);
  validate(options.optical_flow);
  validate(options.depth);
  validate(options.segmentation);
  const auto require_that = [](bool condition, std::vector<std::string> names, const std::string& text) {
    if (!condition) throw InvalidParameter(std::move(names), text);
  };
  const FieldList own = fieldsOf(options);
  const FieldList flow = fieldsOf(options.optical_flow);
  require(!options.mask_to_velocity || options.velocity != VelocitySource::kGroundTruth, own,
          {&options.mask_to_velocity, &options.velocity}, "the velocity must be estimated from radar");
  require_that(options.optical_flow.flow.working_width == options.depth.working_width,
               {flow.of(&options.optical_flow.flow.working_width).name},
               fmt::format("working_width of flow ({} px) and depth ({} px) must agree here",
                           options.optical_flow.flow.working_width, options.depth.working_width));
  if (!options.segmentation.look_back && !(options.segmentation.memory > 0.0)) return;
  require(!fileSourceOf(options.optical_flow.flow.backend), flow, {&options.optical_flow.flow.backend},
          "look_back and memory need a backend, which computes the backward flow");
  require(options.optical_flow.flow.forward_backward, flow, {&options.optical_flow.flow.forward_backward},
          "look_back and memory need the backward flow");
  require(options.segmentation.byUncertainty(), fieldsOf(options.segmentation),
          {&options.segmentation.motion.score}, "look_back and memory need the score by uncertainty");
}

SegmentationReport evaluateSegmentation(const Tables& tables, Index scene,
                                        const std::vector<const dataset::InstanceMask*>& masks,
                                        const SegmentationEvaluationOptions& options,
                                        const std::function<void(std::size_t, std::size_t)>& progress) {
  validate(options);
  const std::vector<ImagePair> pairs = pairsOf(tables, scene, options.pairs);
  std::map<dataset::Token, std::vector<const dataset::InstanceMask*>> by_image;
  for (const dataset::InstanceMask* mask : masks) by_image[mask->sample_data_token].push_back(mask);
  requireTruth(tables, masks, options.pairs.camera);
  SceneRunner runner(tables, scene, options);
  SegmentationReport report;
  report.scene = tables.scenes[at(scene)].name;
  std::size_t done = 0;
  for (const ImagePair& pair : pairs) {
    const dataset::SampleData& first = tables.sample_data[at(pair.first)];
    const auto found = by_image.find(first.token);
    // An image without instances is one in which nothing moves.
    const cv::Size size(first.width, first.height);
    cv::Mat truth = cv::Mat::zeros(size, CV_8UC1), people;
    if (found != by_image.end()) {
      truth = resizeNearest(dynamicMask(tables, found->second), size);
      people = resizeNearest(dynamicMask(tables, peopleIn(found->second)), size);
    }
    runner.evaluate(pair, truth, people, report);
    if (progress) progress(++done, pairs.size());
  }
  return report;
}

}  // namespace radar_dot::evaluation
