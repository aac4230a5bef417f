// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "can_fields.h"
#include "vocabulary.h"

namespace radar_dot::dataset {
namespace {

constexpr double kUnitTolerance = 1e-6;
constexpr int kMaxSide = std::numeric_limits<std::uint16_t>::max();  ///< px, what readers make room for

template <std::size_t N>
bool isFinite(const std::array<double, N>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Checks one part of the scene after the other and keeps in mind where it is, for the messages.
class SceneCheck {
 public:
  explicit SceneCheck(const NewScene& scene) : scene_(scene) {}

  void run() {
    checkNames();
    checkSensors();
    checkSamples();
    checkReadings();
    checkInstances();
    checkAnnotations();
    checkMasks();
    checkCanBus();
  }

 private:
  [[noreturn]] void fail(std::string_view complaint) const {
    throw std::invalid_argument(
        fmt::format("scene '{}': {}{}{}", scene_.name, where_, where_.empty() ? "" : ": ", complaint));
  }
  void require(bool condition, std::string_view complaint) const {
    if (!condition) fail(complaint);
  }
  void enter(std::string_view part, std::size_t number) { where_ = fmt::format("{} {}", part, number); }
  void requireBelow(std::size_t number, std::size_t size, std::string_view what) const {
    if (number >= size) fail(fmt::format("{} {} does not exist, there are {}", what, number, size));
  }
  void requirePose(const std::array<double, 3>& translation, const std::array<double, 4>& rotation) const {
    require(isFinite(translation), "the translation is not finite");
    requireRotation(rotation);
  }
  void requireRotation(const std::array<double, 4>& q) const {
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(std::abs(norm - 1.0) < kUnitTolerance))
      fail(fmt::format("the rotation must be a unit quaternion w x y z but its norm is {:.6g}", norm));
  }
  void requireAttributes(const std::vector<std::string>& attributes) const {
    for (const std::string& name : attributes)
      if (!isAttribute(name)) fail(fmt::format("nuScenes knows no attribute '{}'", name));
  }
  void requireVisibility(int level) const {
    if (!isVisibility(level)) fail(fmt::format("the visibility must be one of 1..4 but is {}", level));
  }

  void checkNames() const {
    require(isPlainName(scene_.name), "the name must be a plain file name");
    require(isPlainName(scene_.log_name), "the log name must be a plain file name");
  }

  void checkSensors() {
    std::set<std::string_view> channels;
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      enter("sensor", i);
      const NewSensor& sensor = scene_.sensors[i];
      require(isPlainName(sensor.channel), "the channel must be a plain file name");
      require(channels.insert(sensor.channel).second, "another sensor has this channel");
      const bool is_camera = sensor.modality == "camera";
      require(is_camera || sensor.modality == "lidar" || sensor.modality == "radar",
              "the modality must be camera, lidar or radar");
      requirePose(sensor.translation, sensor.rotation);
      require(sensor.camera_matrix.size() == (is_camera ? 9U : 0U),
              "the camera matrix must hold 9 numbers for a camera and none for others");
      for (const double value : sensor.camera_matrix)
        require(std::isfinite(value), "the camera matrix is not finite");
    }
  }

  void checkSamples() {
    where_.clear();
    require(!scene_.samples_us.empty(), "there are no samples");
    for (std::size_t i = 1; i < scene_.samples_us.size(); ++i) {
      enter("sample", i);
      require(scene_.samples_us[i - 1] < scene_.samples_us[i], "not later than the sample before it");
    }
  }

  void checkReadings() {
    std::set<std::string_view> filenames;
    std::set<std::pair<std::size_t, std::size_t>> key_frames;
    std::vector<const NewReading*> previous(scene_.sensors.size(), nullptr);
    for (std::size_t i = 0; i < scene_.readings.size(); ++i) {
      enter("reading", i);
      const NewReading& reading = scene_.readings[i];
      requireBelow(reading.sensor, scene_.sensors.size(), "sensor");
      requireBelow(reading.sample, scene_.samples_us.size(), "sample");
      const NewReading*& before = previous[reading.sensor];
      require(before == nullptr || before->timestamp_us < reading.timestamp_us,
              "not later than the reading of its sensor before it");
      before = &reading;
      requirePose(reading.ego_pose.translation, reading.ego_pose.rotation);
      requireFilename(reading.filename);
      require(filenames.insert(reading.filename).second, "another reading has this file name");
      require(!reading.file_format.empty(), "there is no file format");
      requireSize(reading);
      require(!reading.is_key_frame || key_frames.emplace(reading.sensor, reading.sample).second,
              "its sensor has another key frame for this sample");
    }
  }

  void requireFilename(const std::filesystem::path& file) const {
    const bool leaves = std::find(file.begin(), file.end(), "..") != file.end();
    require(file.has_filename() && file.is_relative() && !leaves,
            "the file name must be relative to the dataroot and inside of it");
  }

  void requireSize(const NewReading& reading) const {
    const int smallest = scene_.sensors[reading.sensor].modality == "camera" ? 1 : 0;
    if (std::min(reading.width, reading.height) < smallest ||
        std::max(reading.width, reading.height) > kMaxSide)
      fail(fmt::format("width and height must lie in {}..{} but are {} and {}", smallest, kMaxSide,
                       reading.width, reading.height));
  }

  void checkInstances() {
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      enter("instance", i);
      if (!isCategory(scene_.instances[i]))
        fail(fmt::format("nuScenes knows no category '{}'", scene_.instances[i]));
    }
  }

  void checkAnnotations() {
    std::set<std::pair<std::size_t, std::size_t>> seen;
    for (std::size_t i = 0; i < scene_.annotations.size(); ++i) {
      enter("annotation", i);
      const NewAnnotation& annotation = scene_.annotations[i];
      requireBelow(annotation.sample, scene_.samples_us.size(), "sample");
      requireBelow(annotation.instance, scene_.instances.size(), "instance");
      require(seen.emplace(annotation.instance, annotation.sample).second,
              "its instance has another annotation in this sample");
      annotated_.insert(annotation.instance);
      requirePose(annotation.translation, annotation.rotation);
      for (const double side : annotation.size)
        require(side > 0.0 && std::isfinite(side), "the size must be positive");
      requireAttributes(annotation.attributes);
      requireVisibility(annotation.visibility);
      require(annotation.lidar_points >= 0 && annotation.radar_points >= 0,
              "the numbers of points must not be negative");
    }
  }

  void checkMasks() {
    std::set<std::pair<std::size_t, std::size_t>> seen;
    for (std::size_t i = 0; i < scene_.masks.size(); ++i) {
      enter("mask", i);
      const NewMask& mask = scene_.masks[i];
      requireBelow(mask.reading, scene_.readings.size(), "reading");
      requireBelow(mask.instance, scene_.instances.size(), "instance");
      require(seen.emplace(mask.reading, mask.instance).second,
              "its instance has another mask in this reading");
      const NewReading& reading = scene_.readings[mask.reading];
      require(scene_.sensors[reading.sensor].modality == "camera" && reading.is_key_frame,
              "its reading must be a key frame of a camera");
      require(annotated_.count(mask.instance) != 0, "its instance has no annotation in this scene");
      requireAttributes(mask.attributes);
      requireVisibility(mask.visibility);
      if (mask.mask.columns != reading.width || mask.mask.rows != reading.height)
        fail(fmt::format("its size is {}x{} but that of the image {}x{}", mask.mask.columns, mask.mask.rows,
                         reading.width, reading.height));
      const auto pixels =
          static_cast<std::uint64_t>(reading.width) * static_cast<std::uint64_t>(reading.height);
      require(std::accumulate(mask.mask.counts.begin(), mask.mask.counts.end(), std::uint64_t{0}) == pixels,
              "its runs do not add up to the image");
    }
  }

  void checkCanBus() {
    checkCanPart("CAN pose", scene_.can_bus.poses);
    checkCanPart("CAN IMU message", scene_.can_bus.imu);
    checkCanPart("CAN vehicle message", scene_.can_bus.vehicle);
  }

  template <typename Row>
  void checkCanPart(std::string_view part, const std::vector<Row>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      enter(part, i);
      require(i == 0 || rows[i - 1].timestamp_us < rows[i].timestamp_us, "not later than the one before it");
      forEachCanField(rows[i], [this](std::string_view, const auto& value) { this->checkCanValue(value); });
    }
  }
  void checkCanValue(double value) const { checkCanValue(std::array<double, 1>{value}); }
  void checkCanValue(const std::array<double, 4>& rotation) const { requireRotation(rotation); }
  template <std::size_t N>
  void checkCanValue(const std::array<double, N>& value) const {
    require(isFinite(value), "a value is not finite");
  }

  const NewScene& scene_;
  std::string where_;
  std::set<std::size_t> annotated_;  ///< instances
};

}  // namespace

bool isPlainName(std::string_view name) {
  return !name.empty() && name.front() != '.' && name.find('/') == std::string_view::npos &&
         name.find('\0') == std::string_view::npos;
}

void checkScene(const NewScene& scene) { SceneCheck(scene).run(); }

}  // namespace radar_dot::dataset
