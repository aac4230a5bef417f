// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/common/stamps.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/pose_track.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot::evaluation {

/// Rows as indices of the tables.
inline std::size_t at(dataset::Index row) { return static_cast<std::size_t>(row); }
using radar_dot::secondsOf;
/// Stamp of a reading, s.
inline double secondsOf(const dataset::SampleData& reading) { return secondsOf(reading.timestamp_us); }

/// One scan of one radar, read and filtered.
struct LoadedScan {
  double time = 0.0;                       ///< s
  dataset::Index sample = dataset::kNone;  ///< the keyframe it belongs to
  bool is_key_frame = false;
  std::vector<DopplerReturn> returns;
};

/// All scans of one radar in time order.
struct LoadedRadar {
  std::string channel;
  std::size_t number = 0;  ///< in the scene
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  std::vector<LoadedScan> scans;
  std::size_t listed = 0;  ///< readings in the tables; those without a file are not in `scans`

  RadarScan scan(std::size_t index) const {
    return {scans[index].returns, T_base_from_sensor, scans[index].time, number};
  }
};

/// The scan of a radar nearest to `time`, or nothing beyond `reach` seconds.
std::optional<std::size_t> nearestScan(const LoadedRadar& radar, double time, double reach);

/// What the evaluation needs of a scene.
struct RadarScene {
  std::vector<LoadedRadar> radars;
  std::vector<double> keyframe_times;            ///< s
  std::vector<dataset::Index> keyframe_samples;  ///< rows, by keyframe
  PoseTrack truth;
  std::vector<dataset::CanVehicleInfo> wheels;
  EgoVelocityConfig config;  ///< by which it was read
};

/// Reads the scans of `channels` (empty = every radar), the poses and the wheel speeds of a scene. Scans are
/// read, and mounts corrected, by `config`, as the nodelet does (see
/// VelocityEvaluationOptions::ego_velocity).
/// @throws dataset::DatasetError for unreadable files, a channel that is no radar of the scene or,
///         named in `channels`, has no file; keyframes out of order; a scene with fewer than two poses
///         or with poses of another time.
RadarScene loadRadarScene(const dataset::Tables& tables, dataset::Index scene,
                          const std::vector<std::string>& channels, const EgoVelocityConfig& config);
/// The radar of a channel as configured, with the values and the name of its preset, and its name; where it
/// is not, the channel in lower case is its topic and name.
std::pair<std::string, RadarEntry> entryOf(const EgoVelocityConfig& config, const std::string& channel);
/// Config with the corrections "CHANNEL=RAD" in its radars. @throws std::invalid_argument for other texts
EgoVelocityConfig withMountCorrections(EgoVelocityConfig config, const std::vector<std::string>& corrections);

}  // namespace radar_dot::evaluation
