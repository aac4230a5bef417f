// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/drive_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "radar_dot/common/random_stream.h"

namespace radar_dot::simulation {
namespace {

constexpr double kSamplePeriod = 0.5;  // s
constexpr std::int64_t kSceneDistanceUs = 1'000'000'000;
constexpr int kMostThreads = 1024;
constexpr double kRadarJitter = 1e-3;  // s
constexpr std::uint64_t kPlanStream = 0x71a2;

/// When the cameras' keyframes are taken, seconds from the lidar's: the lidar triggers a camera as it
/// sweeps past its field of view, and stamps its own turn at the end.
double cameraOffset(const std::string& channel) {
  if (channel == "CAM_FRONT_LEFT") return -0.0431;
  if (channel == "CAM_FRONT") return -0.0355;
  if (channel == "CAM_FRONT_RIGHT") return -0.0276;
  if (channel == "CAM_BACK_RIGHT") return -0.0201;
  if (channel == "CAM_BACK") return -0.0104;
  return -0.0005;
}

std::int64_t microseconds(double seconds) { return std::llround(1e6 * seconds); }

std::vector<DriveSensor> sensorsOf(const DriveOptions& options, RandomStream& random) {
  std::vector<DriveSensor> sensors;
  const auto& cameras = cameraMounts();
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (std::find(options.cameras.begin(), options.cameras.end(), cameras[i].channel) !=
        options.cameras.end())
      sensors.push_back(
          {SensorKind::kCamera, cameras[i], i, options.camera_rate, cameraOffset(cameras[i].channel)});
  const auto& radars = radarMounts();
  for (std::size_t i = 0; i < radars.size(); ++i) {
    // Drawn for every radar, so that a phase does not depend on what else is on.
    const double offset = random.uniform(-0.5, 0.5) / std::max(2.0, options.radar_rate);
    if (options.radar_rate > 0.0)
      sensors.push_back(
          {SensorKind::kRadar, radars[i], i, options.radar_rate * random.uniform(0.998, 1.002), offset});
  }
  if (options.lidar_rate > 0.0)
    sensors.push_back({SensorKind::kLidar, lidarMount(), 0, options.lidar_rate, 0.0});
  return sensors;
}

/// Times of one sensor's readings, s since the first keyframe.
std::vector<double> readingTimes(const DriveSensor& sensor, double last_sample_s, RandomStream& random) {
  const double period = 1.0 / sensor.rate;
  // The image after the last keyframe belongs to the drive; other sensors stop with it.
  const double end =
      last_sample_s + sensor.offset_s + (sensor.kind == SensorKind::kCamera ? 1.01 : 0.5) * period;
  std::vector<double> times;
  for (int i = 0; sensor.offset_s + i * period <= end; ++i) {
    const double jitter =
        sensor.kind == SensorKind::kRadar ? random.uniform(-kRadarJitter, kRadarJitter) : 0.0;
    times.push_back(sensor.offset_s + i * period + jitter);
  }
  return times;
}

/// A reading belongs to the keyframe that follows it, as in nuScenes; after the last, to that.
std::size_t sampleOf(double time_s, std::size_t samples) {
  const double number = std::ceil(time_s / kSamplePeriod - 1e-6);
  return static_cast<std::size_t>(std::clamp(number, 0.0, static_cast<double>(samples - 1)));
}

/// Readings of one sensor; one of them is the keyframe of each sample.
std::vector<PlannedReading> readingsOf(const DriveSensor& sensor, std::size_t sensor_number,
                                       std::size_t samples, std::int64_t start_us, RandomStream& random) {
  const double last_sample_s = kSamplePeriod * static_cast<double>(samples - 1);
  std::vector<PlannedReading> readings;
  for (const double time : readingTimes(sensor, last_sample_s, random)) {
    PlannedReading reading;
    reading.sensor = sensor_number;
    reading.timestamp_us = start_us + microseconds(time);
    reading.time_s = 1e-6 * static_cast<double>(reading.timestamp_us - start_us);
    reading.sample = sampleOf(time - sensor.offset_s, samples);
    readings.push_back(reading);
  }
  for (std::size_t sample = 0; sample < samples; ++sample) {
    const double target = kSamplePeriod * static_cast<double>(sample) + sensor.offset_s;
    const auto nearest =
        std::min_element(readings.begin(), readings.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.time_s - target) < std::abs(b.time_s - target);
        });
    nearest->is_key_frame = true;
    nearest->sample = sample;
  }
  return readings;
}

/// Leaves out the images that were not asked for.
void thinOut(CameraFrames frames, std::vector<PlannedReading>& readings) {
  if (frames == CameraFrames::kAll) return;
  std::vector<PlannedReading> kept;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const bool follows = i > 0 && readings[i - 1].is_key_frame;
    if (readings[i].is_key_frame || (frames == CameraFrames::kPairs && follows)) kept.push_back(readings[i]);
  }
  readings = std::move(kept);
}

constexpr double kLeastRate = 2.0;  // Hz, of keyframes
constexpr double kMostRate = 100.0;

void checkRate(const FieldList& fields, const double& rate) {
  require(rate == 0.0 || rate >= kLeastRate, fields, {&rate},
          fmt::format("it must be at least {:g} Hz, or 0 to leave the sensor out", kLeastRate));
}

}  // namespace

void DriveOptions::describe(FieldList& fields) {
  fields.group("Drive");
  fields.add("duration", duration_s, "From the first keyframe of a scene to the last", "s",
             {1e-3, kLongestDrive});
  fields.add("seed", seed, "Of everything random: same seed, same bytes");
  fields.add("threads", threads, "Threads that work; 0: one per core. The result does not depend on them", "",
             {0, kMostThreads});
  fields.group("Sensors");
  fields.add("cameras", cameras, "Cameras by channel; all: every one");
  fields.add("width", width, "Width of the images", "px", {64, 8192});
  fields.add("height", height, "Height of the images", "px", {36, 8192});
  fields.add("frames", frames, "Which images a camera takes");
  fields.add("camera_rate", camera_rate, "Rate of the cameras", "Hz", {kLeastRate, kMostRate});
  fields.add("radar_rate", radar_rate, "Rate of the radars; 0: no radars", "Hz", {0.0, kMostRate});
  fields.add("lidar_rate", lidar_rate, "Rate of the lidar; 2: keyframes only, 0: no lidar", "Hz",
             {0.0, kMostRate});
  fields.add("ground_truth", ground_truth,
             "Of which images of CAM_FRONT exact depth, flow, occlusion and masks are written");
}

void checkOptions(const DriveOptions& options) {
  const FieldList fields = fieldsOf(options);
  checkFields(fields);
  checkRate(fields, options.radar_rate);
  checkRate(fields, options.lidar_rate);
  require(!options.cameras.empty(), fields, {&options.cameras}, "at least one is needed");
  std::string names;
  for (const CameraMount& mount : cameraMounts()) names += (names.empty() ? "" : ", ") + mount.channel;
  for (const std::string& channel : options.cameras) {
    const auto& mounts = cameraMounts();
    if (std::none_of(mounts.begin(), mounts.end(),
                     [&](const CameraMount& m) { return m.channel == channel; }))
      throw InvalidParameter({"cameras"}, fmt::format("cameras: there is no {}, only {}", channel, names));
  }
}

DrivePlan planDrive(const DriveOptions& options, std::size_t number) {
  RandomStream random(options.seed, kPlanStream + number);
  DrivePlan plan;
  plan.start_us = kFirstSceneUs + static_cast<std::int64_t>(number) * kSceneDistanceUs;
  const auto samples = static_cast<std::size_t>(std::floor(options.duration_s / kSamplePeriod + 1e-9)) + 1;
  for (std::size_t sample = 0; sample < samples; ++sample)
    plan.samples_us.push_back(plan.start_us + microseconds(kSamplePeriod * static_cast<double>(sample)));
  plan.sensors = sensorsOf(options, random);
  for (std::size_t sensor = 0; sensor < plan.sensors.size(); ++sensor) {
    auto readings = readingsOf(plan.sensors[sensor], sensor, samples, plan.start_us, random);
    if (plan.sensors[sensor].kind == SensorKind::kCamera) thinOut(options.frames, readings);
    for (std::size_t i = 0; i + 1 < readings.size(); ++i) readings[i].next_us = readings[i + 1].timestamp_us;
    plan.readings.insert(plan.readings.end(), readings.begin(), readings.end());
  }
  return plan;
}

}  // namespace radar_dot::simulation
