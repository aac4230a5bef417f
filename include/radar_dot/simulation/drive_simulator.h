// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "radar_dot/common/enum_names.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/dataset/new_scene.h"
#include "radar_dot/simulation/camera_sensor.h"
#include "radar_dot/simulation/chassis_sensors.h"
#include "radar_dot/simulation/lidar_sensor.h"
#include "radar_dot/simulation/scenario.h"

namespace radar_dot {
namespace simulation {

/// Which images a camera takes.
enum class CameraFrames { kAll, kPairs, kKeyframes };

/// Which CAM_FRONT images come with exact images under ground_truth/.
enum class GroundTruth { kAll, kKeyframes, kNone };

}  // namespace simulation

template <>
struct EnumNames<simulation::CameraFrames> {
  static constexpr EnumName<simulation::CameraFrames> kValues[] = {
      {simulation::CameraFrames::kAll, "all", "all at the camera's rate"},
      {simulation::CameraFrames::kPairs, "pairs", "keyframes and the image after each"},
      {simulation::CameraFrames::kKeyframes, "keyframes", "2 Hz"}};
};

template <>
struct EnumNames<simulation::GroundTruth> {
  static constexpr EnumName<simulation::GroundTruth> kValues[] = {
      {simulation::GroundTruth::kAll, "all", "of all images"},
      {simulation::GroundTruth::kKeyframes, "keyframes", "of keyframes"},
      {simulation::GroundTruth::kNone, "none", "of none"}};
};

namespace simulation {

struct DriveOptions {
  double duration_s = 20.0;
  int width = kFullWidth, height = kFullHeight;
  std::vector<std::string> cameras = {"CAM_FRONT"};
  CameraFrames frames = CameraFrames::kAll;
  double camera_rate = 12.0;
  double radar_rate = 13.0;
  double lidar_rate = 20.0;
  GroundTruth ground_truth = GroundTruth::kAll;
  std::uint64_t seed = 1;
  int threads = 0;
  ImageSensorParams image;
  LidarModel lidar;
  ChassisModel chassis;

  void describe(FieldList& fields);
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

/// @throws InvalidParameter of an option, with what is valid.
void checkOptions(const DriveOptions& options);

}  // namespace simulation
}  // namespace radar_dot
