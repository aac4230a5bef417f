// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "radar_dot/bag/ground_truth.h"
#include "radar_dot/bag/scene_converter.h"
#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::bag {

/// Everything of a scene that goes into its bag, sensor files by row only: they are read when
/// they are written.
struct SceneContent {
  std::vector<dataset::Index> mounts;    ///< first reading of each sensor, for its calibration
  std::vector<dataset::Index> readings;  ///< of the chosen channels, on disk
  std::vector<dataset::Index> poses;
  std::vector<StampedTwist> twists;  ///< at the poses
  dataset::CanBus can;
  std::vector<dataset::Index> keyframes;  ///< with boxes
  /// Images with masks, by reading.
  std::map<dataset::Index, std::vector<const dataset::InstanceMask*>> masks;
  std::map<std::string, FileCount> missing;
};

/// @throws as convertScene.
SceneContent collectContent(const dataset::Tables& tables, dataset::Index scene,
                            const ConvertOptions& options);

/// What happens at one time; kinds in the order of events of the same time.
enum class EventKind : std::uint8_t { kEgoPose, kBoxes, kImu, kWheelSpeed, kReading, kMask };

struct Event {
  std::int64_t time_us = 0;
  EventKind kind = EventKind::kReading;
  std::size_t index = 0;  ///< into the content's list of that kind; masks: the reading's row
};

/// All events of a scene, in order of time.
std::vector<Event> schedule(const dataset::Tables& tables, const SceneContent& content);

}  // namespace radar_dot::bag
