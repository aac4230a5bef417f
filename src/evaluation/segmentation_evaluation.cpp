// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/segmentation_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "radar_dot/dataset/point_files.h"
#include "radar_dot/evaluation/noisy_depth.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/rigid_motion.h"
#include "radar_scene.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::DatasetError;
using dataset::Index;
using dataset::Tables;

constexpr double kRadarReach = 0.1;     // s between an image and the radar scans that go with it
constexpr double kVelocityStep = 0.08;  // s between the velocities that are averaged over an interval
constexpr std::uint8_t kCounts = 0;     // values of the ignore image
constexpr std::uint8_t kIgnored = 255;

std::size_t at(Index row) { return static_cast<std::size_t>(row); }
double secondsOf(const dataset::SampleData& reading) {
  return 1e-6 * static_cast<double>(reading.timestamp_us);
}

/// Two images of one camera.
struct ImagePair {
  Index first = dataset::kNone, second = dataset::kNone;
};

std::vector<ImagePair> pairsOf(const Tables& tables, Index scene,
                               const SegmentationEvaluationOptions& options) {
  const std::vector<Index> readings = tables.readingsOf(scene, options.channel);
  const std::string& name = tables.scenes[at(scene)].name;
  if (readings.empty()) throw DatasetError(fmt::format("{}: no readings of {}", name, options.channel));
  std::vector<ImagePair> pairs;
  for (std::size_t i = 0; i + 1 < readings.size(); ++i) {
    if (!tables.sample_data[at(readings[i])].is_key_frame) continue;
    std::size_t next = i + 1;
    if (options.pairs == "keyframes") {
      while (next < readings.size() && !tables.sample_data[at(readings[next])].is_key_frame) ++next;
      if (next == readings.size()) break;
    }
    // A dataroot may hold a part of the images.
    if (fs::exists(tables.path(tables.sample_data[at(readings[i])])) &&
        fs::exists(tables.path(tables.sample_data[at(readings[next])])))
      pairs.push_back({readings[i], readings[next]});
  }
  if (pairs.empty()) {
    throw NoImages(fmt::format("{}: no pair of its {} images is under {}", name, options.channel,
                               tables.dataroot().string()));
  }
  if (options.max_pairs > 0 && pairs.size() > options.max_pairs) pairs.resize(options.max_pairs);
  return pairs;
}

/// Runs one scene; keeps what two pairs in a row share.
class SceneRunner {
 public:
  SceneRunner(const Tables& tables, Index scene, const SegmentationEvaluationOptions& options)
      : tables_(tables),
        options_(options),
        radar_(loadRadarScene(tables, scene, options.radar_channels, options.extraction)),
        estimator_(options.estimator),
        segmenter_(options.motion) {
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

  void evaluate(const ImagePair& pair, const cv::Mat& truth, SegmentationReport& report);

 private:
  static bool isFromFiles(const std::string& backend) {
    return backend == "ground_truth" || backend == "noisy" || backend == "files";
  }
  const dataset::SampleData& reading(Index row) const { return tables_.sample_data[at(row)]; }
  std::string pngName(Index row) const { return tables_.path(reading(row)).stem().string() + ".png"; }
  fs::path truthFile(const char* folder, Index row) const {
    return tables_.dataroot() / "ground_truth" / folder / pngName(row);
  }

  CameraIntrinsics cameraOf(Index row) const;
  CameraIntrinsics gridOf(const CameraIntrinsics& camera) const;
  const cv::Mat& imageOf(Index row);
  const cv::Mat& depthOf(Index row, const CameraIntrinsics& grid);
  cv::Mat computeDepth(Index row, const CameraIntrinsics& grid);
  std::vector<Eigen::Vector3f> radarPoints(double time) const;
  std::vector<Eigen::Vector3f> lidarPoints(double time, const dataset::SampleData& image) const;
  FlowField trueFlow(const ImagePair& pair, const cv::Size& size) const;
  FlowField flowOf(const ImagePair& pair, const MotionInput& input);
  struct Velocity {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3f> dynamic_points;  // m, base frame, nearest to the begin
  };
  std::optional<Velocity> velocityOf(double begin, double end);
  std::optional<Eigen::Isometry3d> motionOf(const ImagePair& pair, MotionInput& input);
  cv::Mat ignoredOf(const ImagePair& pair, const CameraIntrinsics& grid, double pixel_scale) const;

  const Tables& tables_;
  const SegmentationEvaluationOptions& options_;
  RadarScene radar_;
  EgoVelocityEstimator estimator_;
  MotionSegmenter segmenter_;
  std::unique_ptr<OpticalFlow> flow_;
  std::unique_ptr<DepthEstimator> depth_;
  std::map<Index, cv::Mat> images_, depths_;  // of the latest pair
};

CameraIntrinsics SceneRunner::cameraOf(Index row) const {
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

CameraIntrinsics SceneRunner::gridOf(const CameraIntrinsics& camera) const {
  const int width = options_.working_width;
  if (width <= 0 || width >= camera.width) return camera;
  return camera.scaledTo(
      width,
      std::max(2, static_cast<int>(std::lround(static_cast<double>(camera.height) * width / camera.width))));
}

const cv::Mat& SceneRunner::imageOf(Index row) {
  cv::Mat& image = images_[row];
  if (image.empty()) {
    const fs::path path = tables_.path(reading(row));
    image = cv::imread(path.string(), cv::IMREAD_COLOR);
    if (image.empty()) throw DatasetError(fmt::format("{}: cannot be read as an image", path.string()));
  }
  return image;
}

std::vector<Eigen::Vector3f> SceneRunner::radarPoints(double time) const {
  std::vector<Eigen::Vector3f> points;
  for (const LoadedRadar& radar : radar_.radars) {
    const std::optional<std::size_t> nearest = nearestScan(radar, time, kRadarReach);
    if (!nearest) continue;
    const Eigen::Isometry3f T_base_from_sensor = radar.T_base_from_sensor.cast<float>();
    for (const DopplerReturn& seen : radar.scans[*nearest].returns)
      points.emplace_back(T_base_from_sensor * (seen.range * seen.bearing));
  }
  return points;
}

std::vector<Eigen::Vector3f> SceneRunner::lidarPoints(double time, const dataset::SampleData& image) const {
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
      radar_.truth.at(time).inverse() * radar_.truth.at(secondsOf(*nearest)) *
      tables_.calibrated_sensors[at(nearest->calibrated_sensor)].T_base_from_sensor;
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

cv::Mat SceneRunner::computeDepth(Index row, const CameraIntrinsics& grid) {
  const cv::Size size(grid.width, grid.height);
  if (options_.depth == "files")
    return resizeNearest(readDepth(fs::path(options_.depth_directory) / pngName(row)), size);
  if (options_.depth == "ground_truth") return resizeNearest(readDepth(truthFile("depth", row)), size);
  if (options_.depth == "noisy") {
    return noisyDepth(resizeNearest(readDepth(truthFile("depth", row)), size), {},
                      static_cast<std::uint64_t>(reading(row).timestamp_us));
  }
  DepthInput input;
  input.image = imageOf(row);
  input.camera = grid;
  input.T_base_from_camera =
      tables_.calibrated_sensors[at(reading(row).calibrated_sensor)].T_base_from_sensor;
  const double time = secondsOf(reading(row));
  if (options_.depth == "lidar") {
    input.lidar_points = lidarPoints(time, reading(row));
  } else {
    input.radar_points = radarPoints(time);
  }
  return depth_->estimate(input);
}

const cv::Mat& SceneRunner::depthOf(Index row, const CameraIntrinsics& grid) {
  cv::Mat& depth = depths_[row];
  if (depth.empty()) depth = computeDepth(row, grid);
  return depth;
}

FlowField SceneRunner::trueFlow(const ImagePair& pair, const cv::Size& size) const {
  const bool keyframes = options_.pairs == "keyframes";
  FlowField field = readFlow(truthFile(keyframes ? "keyframe_flow" : "flow", pair.first));
  const cv::Mat occlusion = readGrey(truthFile(keyframes ? "keyframe_occlusion" : "occlusion", pair.first));
  if (occlusion.size() != field.flow.size()) {
    throw DatasetError(truthFile("occlusion", pair.first).string() + ": has another size than the flow");
  }
  field.valid.setTo(0, occlusion != 0);
  return resizeNearest(field, size);
}

FlowField SceneRunner::flowOf(const ImagePair& pair, const MotionInput& input) {
  const cv::Size size(input.camera.width, input.camera.height);
  if (options_.flow == "ground_truth") return trueFlow(pair, size);
  FlowField field;
  if (options_.flow == "files") {
    field = readFlow(fs::path(options_.flow_directory) / pngName(pair.first));
    // Flow of a network is smooth within objects: better interpolated.
    return {resizeFlow(field.flow, size), resizeNearest(field.valid, size)};
  }
  cv::Mat expected;
  if (options_.optical_flow.initialisation == "expected")
    expected = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  field = flow_->compute(imageOf(pair.first), imageOf(pair.second), expected);
  if (field.flow.size() == size) return field;
  if (!field.valid.empty()) field.valid = resizeNearest(field.valid, size);
  field.flow = resizeFlow(field.flow, size);
  return field;
}

std::optional<SceneRunner::Velocity> SceneRunner::velocityOf(double begin, double end) {
  const int steps = options_.velocity == "radar_start"
                        ? 1
                        : std::max(1, static_cast<int>(std::lround((end - begin) / kVelocityStep)));
  Velocity mean;
  int count = 0;
  for (int i = 0; i < steps; ++i) {
    const double time =
        options_.velocity == "radar_start" ? begin : begin + (end - begin) * (i + 0.5) / steps;
    std::vector<RadarScan> scans;
    for (const LoadedRadar& radar : radar_.radars) {
      if (const std::optional<std::size_t> nearest = nearestScan(radar, time, kRadarReach))
        scans.push_back(radar.scan(*nearest));
    }
    const EgoVelocityResult& result = estimator_.estimate(scans, time);
    if (!result.valid()) continue;
    mean.linear += result.linear;
    mean.angular += result.angular;
    if (count++ > 0) continue;
    for (std::size_t scan = 0; scan < scans.size(); ++scan) {
      for (std::size_t k = 0; k < scans[scan].returns->size(); ++k) {
        if (result.labels[result.offsets[scan] + k] != ReturnLabel::kDynamic) continue;
        const DopplerReturn& seen = (*scans[scan].returns)[k];
        mean.dynamic_points.emplace_back(scans[scan].T_base_from_sensor.cast<float>() *
                                         (seen.range * seen.bearing));
      }
    }
  }
  if (count == 0) return std::nullopt;
  mean.linear /= count;
  mean.angular /= count;
  return mean;
}

std::optional<Eigen::Isometry3d> SceneRunner::motionOf(const ImagePair& pair, MotionInput& input) {
  const double begin = secondsOf(reading(pair.first));
  const double end = secondsOf(reading(pair.second));
  const Eigen::Isometry3d truth = radar_.truth.at(begin).inverse() * radar_.truth.at(end);
  const Eigen::Isometry3d T_base_from_camera =
      tables_.calibrated_sensors[at(reading(pair.first).calibrated_sensor)].T_base_from_sensor;
  if (options_.velocity == "ground_truth" && options_.rotation == "ground_truth" &&
      options_.motion.radar_gain == 0.0)
    return truth;
  const std::optional<Velocity> velocity = velocityOf(begin, end);
  if (!velocity) return std::nullopt;
  const Eigen::Isometry3f T_camera_from_base = T_base_from_camera.inverse().cast<float>();
  for (const Eigen::Vector3f& point : velocity->dynamic_points)
    input.dynamic_points.emplace_back(T_camera_from_base * point);
  Eigen::Isometry3d motion = options_.rotation == "ground_truth"
                                 ? baseMotionWithRotation(velocity->linear, truth.linear(), end - begin)
                                 : baseMotion(velocity->linear, velocity->angular, end - begin);
  if (options_.velocity == "ground_truth") motion.translation() = truth.translation();
  return motion;
}

/// Movers whose true flow hardly differs from that of a static world, or that the other image does not show.
cv::Mat SceneRunner::ignoredOf(const ImagePair& pair, const CameraIntrinsics& grid,
                               double pixel_scale) const {
  const cv::Size size(grid.width, grid.height);
  const FlowField flow = trueFlow(pair, size);
  const cv::Mat depth = resizeNearest(readDepth(truthFile("depth", pair.first)), size);
  const Eigen::Isometry3d T_base_from_camera =
      tables_.calibrated_sensors[at(reading(pair.first).calibrated_sensor)].T_base_from_sensor;
  const Eigen::Isometry3d truth = radar_.truth.at(secondsOf(reading(pair.first))).inverse() *
                                  radar_.truth.at(secondsOf(reading(pair.second)));
  const cv::Mat expected = expectedFlow(grid, staticPointMotion(T_base_from_camera, truth), depth);
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

void count(const cv::Mat& mask, const cv::Mat& truth, const cv::Mat& ignored, Confusion& pixels) {
  for (int row = 0; row < truth.rows; ++row) {
    const auto* predicted = mask.ptr<std::uint8_t>(row);
    const auto* actual = truth.ptr<std::uint8_t>(row);
    const auto* ignore = ignored.empty() ? nullptr : ignored.ptr<std::uint8_t>(row);
    for (int column = 0; column < truth.cols; ++column) {
      const bool moves = actual[column] != 0;
      if (moves && ignore != nullptr && ignore[column] != kCounts) continue;
      pixels.add(predicted[column] != 0, moves);
    }
  }
}

void SceneRunner::evaluate(const ImagePair& pair, const cv::Mat& truth, SegmentationReport& report) {
  for (std::map<Index, cv::Mat>* kept : {&images_, &depths_}) {
    for (auto entry = kept->begin(); entry != kept->end();)
      entry = entry->first == pair.first ? std::next(entry) : kept->erase(entry);
  }
  const CameraIntrinsics camera = cameraOf(pair.first);
  MotionInput input;
  input.camera = gridOf(camera);
  input.pixel_scale = static_cast<double>(camera.width) / input.camera.width;
  const std::optional<Eigen::Isometry3d> motion = motionOf(pair, input);
  ++report.frames;
  cv::Mat mask = cv::Mat::zeros(input.camera.height, input.camera.width, CV_8UC1);
  if (motion) {
    input.T_current_from_previous = staticPointMotion(
        tables_.calibrated_sensors[at(reading(pair.first).calibrated_sensor)].T_base_from_sensor, *motion);
    input.depth = depthOf(pair.first, input.camera);
    input.next_depth = depthOf(pair.second, input.camera);
    const FlowField field = flowOf(pair, input);
    input.flow = field.flow;
    input.flow_valid = field.valid;
    const auto start = std::chrono::steady_clock::now();
    mask = segmenter_.segment(input).mask.clone();
    report.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  } else {
    ++report.without_motion;
  }
  cv::Mat ignored;
  if (options_.min_true_residual > 0.0)
    ignored = resizeNearest(ignoredOf(pair, input.camera, input.pixel_scale), truth.size());
  mask = resizeNearest(mask, truth.size());
  count(mask, truth, ignored, report.pixels);
  if (!options_.mask_directory.empty()) {
    const fs::path file = fs::path(options_.mask_directory) / pngName(pair.first);
    if (!cv::imwrite(file.string(), mask)) throw std::runtime_error(file.string() + ": cannot be written");
  }
}

void validate(const SegmentationEvaluationOptions& options) {
  const auto one_of = [](const char* name, const std::string& value,
                         std::initializer_list<const char*> known) {
    if (std::find(known.begin(), known.end(), value) != known.end()) return;
    std::string names;
    for (const char* each : known) names += (names.empty() ? "" : ", ") + std::string(each);
    throw std::invalid_argument(fmt::format("{} '{}' is not one of {}", name, value, names));
  };
  one_of("pairs", options.pairs, {"keyframes", "next"});
  one_of("velocity", options.velocity, {"radar", "radar_start", "ground_truth"});
  one_of("rotation", options.rotation, {"ground_truth", "radar"});
  if (options.flow == "files" && options.flow_directory.empty())
    throw std::invalid_argument("flow 'files' needs a folder with the flows");
  if (options.depth == "files" && options.depth_directory.empty())
    throw std::invalid_argument("depth 'files' needs a folder with the depths");
}

}  // namespace

SegmentationReport evaluateSegmentation(const Tables& tables, Index scene,
                                        const std::vector<const dataset::InstanceMask*>& masks,
                                        const SegmentationEvaluationOptions& options,
                                        const std::function<void(std::size_t, std::size_t)>& progress) {
  validate(options);
  const std::vector<ImagePair> pairs = pairsOf(tables, scene, options);
  std::map<dataset::Token, std::vector<const dataset::InstanceMask*>> by_image;
  for (const dataset::InstanceMask* mask : masks) by_image[mask->sample_data_token].push_back(mask);
  SceneRunner runner(tables, scene, options);
  SegmentationReport report;
  report.scene = tables.scenes[at(scene)].name;
  std::size_t done = 0;
  for (const ImagePair& pair : pairs) {
    const dataset::SampleData& first = tables.sample_data[at(pair.first)];
    const auto found = by_image.find(first.token);
    // An image without instances is one in which nothing moves.
    cv::Mat truth = found == by_image.end() ? cv::Mat::zeros(first.height, first.width, CV_8UC1)
                                            : dynamicMask(tables, found->second);
    truth = resizeNearest(truth, cv::Size(first.width, first.height));
    runner.evaluate(pair, truth, report);
    if (progress) progress(++done, pairs.size());
  }
  return report;
}

}  // namespace radar_dot::evaluation
