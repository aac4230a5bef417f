// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "radar_dot/dataset/new_scene.h"
#include "radar_dot/simulation/camera_sensor.h"
#include "radar_dot/simulation/chassis_sensors.h"
#include "radar_dot/simulation/lidar_sensor.h"
#include "radar_dot/simulation/scenario.h"

namespace radar_dot::simulation {

/// Which images a camera takes.
enum class CameraFrames {
  kAll,       ///< at the camera's rate
  kPairs,     ///< keyframes and the image after each
  kKeyframes  ///< 2 Hz
};

/// Which CAM_FRONT images come with exact images under ground_truth/.
enum class GroundTruth { kAll, kKeyframes, kNone };

struct DriveOptions {
  double duration_s = 20.0;                          ///< from the first keyframe to the last; 2 Hz
  int width = kFullWidth, height = kFullHeight;      ///< px
  std::vector<std::string> cameras = {"CAM_FRONT"};  ///< channels
  CameraFrames frames = CameraFrames::kAll;
  double camera_rate = 12.0;  ///< Hz; at least 2
  double radar_rate = 13.0;   ///< Hz, 0 = no radars, else at least 2
  double lidar_rate = 20.0;   ///< Hz, 0 = no lidar, else at least 2
  GroundTruth ground_truth = GroundTruth::kAll;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0 = one per core; the result does not depend on it
  ImageSensorParams image;
  LidarModel lidar;
  ChassisModel chassis;
};

/// Time of the first keyframe of the first scene; further scenes start 1000 s later each.
inline constexpr std::int64_t kFirstSceneUs = 1'767'225'600'000'000;

/// Told after every reading, from any thread but one at a time. What it throws ends the simulation.
using DriveProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Drives through a scenario and writes what its sensors see under `folder`: samples/, sweeps/ and
/// ground_truth/. Returns everything the tables need.
/// @param number  of the scene in its dataset, from 0: gives its time stamps
/// @throws std::invalid_argument for invalid options, dataset::DatasetError for files that
///         cannot be written, whatever `progress` throws
dataset::NewScene simulateDrive(const Scenario& scenario, const DriveOptions& options, std::size_t number,
                                const std::filesystem::path& folder, const DriveProgress& progress = {});

/// @throws std::invalid_argument with the option and its bounds.
void checkOptions(const DriveOptions& options);

}  // namespace radar_dot::simulation
