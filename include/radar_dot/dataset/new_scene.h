// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/instance_masks.h"

namespace radar_dot::dataset {

// What a drive consists of, to be written as a scene of a nuScenes dataroot. Unlike the rows of
// Tables these refer to each other by position, so that whoever makes data needs no tokens.

struct NewSensor {
  std::string channel;
  std::string modality;                 ///< camera, lidar, radar
  std::array<double, 3> translation{};  ///< m, sensor origin in the base frame
  std::array<double, 4> rotation{};     ///< w x y z, base from sensor
  std::vector<double> camera_matrix;    ///< row-major 3x3, px; empty unless a camera
};

struct NewPose {
  std::array<double, 3> translation{};  ///< m, base origin in the map frame
  std::array<double, 4> rotation{};     ///< w x y z, map from base
};

/// A reading of a sensor; its file is written by whoever made it.
struct NewReading {
  std::size_t sensor = 0;  ///< number in NewScene::sensors
  std::int64_t timestamp_us = 0;
  std::size_t sample = 0;  ///< keyframe it belongs to
  bool is_key_frame = false;
  std::string filename;     ///< relative to the dataroot
  std::string file_format;  ///< jpg, pcd
  int width = 0, height = 0;
  NewPose ego_pose;
};

struct NewAnnotation {
  std::size_t sample = 0;
  std::size_t instance = 0;             ///< number in NewScene::instances
  std::array<double, 3> translation{};  ///< m, centre of the box, map frame
  std::array<double, 3> size{};         ///< m: width, length, height
  std::array<double, 4> rotation{};     ///< w x y z
  std::vector<std::string> attributes;  ///< names
  int visibility = 4;                   ///< 1..4: up to 40, 60, 80, 100 %
  int lidar_points = 0, radar_points = 0;
};

/// Mask of one instance in one keyframe image.
struct NewMask {
  std::size_t reading = 0;  ///< number in NewScene::readings
  std::size_t instance = 0;
  std::vector<std::string> attributes;  ///< names, at that time
  int visibility = 4;
  RunLengthMask mask;  ///< of the image's size
};

struct NewScene {
  std::string name, description;
  std::string log_name;  ///< e.g. "sim-2026-01-01-00-00-00+0000": unique per scene, part of the file names
  std::string vehicle, date_captured, location;
  std::vector<NewSensor> sensors;
  std::vector<std::int64_t> samples_us;  ///< time stamps of the keyframes
  std::vector<NewReading> readings;      ///< in time order per sensor
  std::vector<std::string> instances;    ///< category name of each
  std::vector<NewAnnotation> annotations;
  std::vector<NewMask> masks;
  CanBus can_bus;
};

}  // namespace radar_dot::dataset
