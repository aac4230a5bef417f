// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "radar_dot/dataset/new_scene.h"

namespace radar_dot::test {

/// A scene of three keyframes (0.5 s apart) with everything that a scene can have, and with numbers that
/// need all of their digits:
/// - CAM_FRONT (16x12 px) and LIDAR_TOP, a key frame each; RADAR_FRONT at 13 Hz with sweeps between its key
///   frames; the readings of all sensors are mixed, in time order.
/// - Instance 0, a moving car, in all keyframes (annotated backwards in time), instance 1, a pedestrian
///   without attributes, in keyframe 1, and instance 2, a truck, never.
/// - Masks of the car in all images, and an empty mask of the pedestrian.
/// - Three CAN messages of each kind.
/// `number` makes the scene "scene-<number>", and all of its values others than those of other numbers.
dataset::NewScene smallScene(int number);

/// Writes the files that the readings name, below `folder`: JPEG images, and point files of as many points
/// as the reading's number modulo 4.
void writeReadingFiles(const dataset::NewScene& scene, const std::filesystem::path& folder);

}  // namespace radar_dot::test
