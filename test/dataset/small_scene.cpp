// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "dataset/small_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "radar_dot/dataset/point_files.h"

namespace radar_dot::test {
namespace {

using namespace dataset;

constexpr std::size_t kCamera = 0, kRadar = 1, kLidar = 2;

std::array<double, 4> yawRotation(double yaw) { return {std::cos(0.5 * yaw), 0.0, 0.0, std::sin(0.5 * yaw)}; }

NewPose egoPose(int number, double seconds) {
  return {{100.0 * number + 7.3 * seconds, std::sqrt(2.0) * seconds, 0.1 / 3.0}, yawRotation(0.1 * seconds)};
}

void addReading(NewScene& scene, int number, std::size_t sensor, std::int64_t offset_us, bool is_key_frame) {
  NewReading reading;
  reading.sensor = sensor;
  reading.timestamp_us = scene.samples_us[0] + offset_us;
  reading.sample = static_cast<std::size_t>(
      std::clamp<std::int64_t>((offset_us + 250000) / 500000, 0, 2));  // the nearest keyframe
  reading.is_key_frame = is_key_frame;
  reading.file_format = sensor == kCamera ? "jpg" : "pcd";
  const std::string& channel = scene.sensors[sensor].channel;
  reading.filename =
      fmt::format("{}/{}/{}__{}__{}.{}", is_key_frame ? "samples" : "sweeps", channel, scene.log_name,
                  channel, reading.timestamp_us, sensor == kLidar ? "pcd.bin" : reading.file_format);
  if (sensor == kCamera) reading.width = 16;
  if (sensor == kCamera) reading.height = 12;
  reading.ego_pose = egoPose(number, 1e-6 * static_cast<double>(offset_us));
  scene.readings.push_back(reading);
}

void addReadings(NewScene& scene, int number) {
  for (int k = 0; k < 3; ++k) {
    addReading(scene, number, kCamera, 500000 * k + 12404, true);
    addReading(scene, number, kLidar, 500000 * k, true);
  }
  // Scans 0, 7 and 13 are the nearest to the keyframes.
  for (int k = 0; k < 14; ++k)
    addReading(scene, number, kRadar, 76923 * k - 11000, k == 0 || k == 7 || k == 13);
  std::sort(scene.readings.begin(), scene.readings.end(),
            [](const NewReading& a, const NewReading& b) { return a.timestamp_us < b.timestamp_us; });
}

void addObjects(NewScene& scene, int number) {
  scene.instances = {"vehicle.car", "human.pedestrian.adult", "vehicle.truck"};
  for (std::size_t sample : {2U, 1U, 0U}) {
    NewAnnotation car;
    car.sample = sample;
    car.instance = 0;
    car.translation = {number + std::exp(static_cast<double>(sample)), 1.0 / 3.0, 0.8};
    car.size = {1.9, std::sqrt(20.0), 1.7};
    car.rotation = yawRotation(-2.0);
    car.attributes = {"vehicle.moving"};
    car.visibility = 1 + static_cast<int>(sample);
    car.lidar_points = 30 + number;
    car.radar_points = static_cast<int>(sample);
    scene.annotations.push_back(car);
  }
  NewAnnotation pedestrian;
  pedestrian.sample = 1;
  pedestrian.instance = 1;
  pedestrian.translation = {-5.5, 2e-7, 1e3 / 7.0};
  pedestrian.size = {0.6, 0.7, 1.75};
  pedestrian.rotation = yawRotation(1.0);
  scene.annotations.push_back(pedestrian);

  for (std::size_t i = 0; i < scene.readings.size(); ++i) {
    const NewReading& reading = scene.readings[i];
    if (reading.sensor != kCamera) continue;
    NewMask car;
    car.reading = i;
    car.instance = 0;
    car.attributes = {"vehicle.moving"};
    car.visibility = 2;
    cv::Mat car_pixels = cv::Mat::zeros(12, 16, CV_8UC1);
    car_pixels(cv::Rect(3, 2 + static_cast<int>(reading.sample), 5, 4)) = 255;
    car_pixels.at<std::uint8_t>(11, number % 16) = 1;  // any nonzero value counts
    car.mask = encodeMask(car_pixels);
    scene.masks.push_back(car);
    if (reading.sample != 1) continue;
    NewMask pedestrian_mask;
    pedestrian_mask.reading = i;
    pedestrian_mask.instance = 1;
    pedestrian_mask.mask = encodeMask(cv::Mat::zeros(12, 16, CV_8UC1));
    scene.masks.push_back(pedestrian_mask);
  }
}

void addCanMessages(NewScene& scene, int number) {
  for (int k = 0; k < 3; ++k) {
    const std::int64_t time_us = scene.samples_us[0] + 10000 * k;
    const double x = number + k / 7.0;
    scene.can_bus.poses.push_back({time_us,
                                   {x, 2.0 * x, 0.0},
                                   yawRotation(x),
                                   {8.0 + x, 0.0, 0.0},
                                   {x, 0.0, 9.8},
                                   {0.0, 0.0, 0.1 * x}});
    scene.can_bus.imu.push_back({time_us + 1, {x, 1.0, 9.8}, yawRotation(-x), {0.1, 0.2 * x, 0.3}});
    scene.can_bus.vehicle.push_back(
        {time_us + 2, 250.0 + x, 251.0 + x, 252.0 + x, 253.0 + x, 32.0 + x, -2.7 * x});
  }
}

}  // namespace

NewScene smallScene(int number) {
  NewScene scene;
  scene.name = fmt::format("scene-{:04d}", number);
  scene.description = fmt::format("Number {}, a \"quoted\" word, a \\ and a line\nbreak", number);
  scene.log_name = fmt::format("sim-2026-01-{:02d}-00-00-00+0000", number);
  scene.vehicle = "sim";
  scene.date_captured = fmt::format("2026-01-{:02d}", number);
  scene.location = "simulated-town";
  scene.sensors = {{"CAM_FRONT",
                    "camera",
                    {1.7, 0.1 / 7.0, 1.5},
                    {0.5, -0.5, 0.5, -0.5},
                    {12.7, 0, 8.1, 0, 12.7, 4.9, 0, 0, 1}},
                   {"RADAR_FRONT", "radar", {3.412, 0.01 * number, 0.5}, yawRotation(0.003), {}},
                   {"LIDAR_TOP", "lidar", {0.94, 0.0, 1.84}, yawRotation(-1.57), {}}};
  for (int k = 0; k < 3; ++k) scene.samples_us.push_back(1767225600000000 + 60000000LL * number + 500000 * k);
  addReadings(scene, number);
  addObjects(scene, number);
  addCanMessages(scene, number);
  return scene;
}

void writeReadingFiles(const NewScene& scene, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < scene.readings.size(); ++i) {
    const NewReading& reading = scene.readings[i];
    const std::filesystem::path file = folder / reading.filename;
    std::filesystem::create_directories(file.parent_path());
    if (reading.sensor == kCamera)
      cv::imwrite(file.string(), cv::Mat(12, 16, CV_8UC3, cv::Scalar(90, 90, 90)));
    if (reading.sensor == kRadar) writeRadarPcd(file, std::vector<RadarRecord>(i % 4));
    if (reading.sensor == kLidar) writeLidarBin(file, std::vector<LidarRecord>(i % 4, {1.0F}));
  }
}

}  // namespace radar_dot::test
