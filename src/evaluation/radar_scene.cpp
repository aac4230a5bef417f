// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "radar_dot/dataset/point_files.h"

namespace radar_dot::evaluation {
namespace {

using dataset::DatasetError;
using dataset::Index;
using dataset::Tables;

std::size_t at(Index row) { return static_cast<std::size_t>(row); }

bool isRadar(const Tables& tables, const std::string& channel) {
  return std::any_of(tables.sensors.begin(), tables.sensors.end(), [&](const dataset::Sensor& sensor) {
    return sensor.channel == channel && sensor.modality == dataset::Modality::kRadar;
  });
}

std::vector<std::string> radarChannels(const Tables& tables, Index scene,
                                       const std::vector<std::string>& wanted) {
  std::vector<std::string> available;
  for (const std::string& channel : tables.channelsOf(scene)) {
    if (isRadar(tables, channel)) available.push_back(channel);
  }
  std::string names;
  for (const std::string& channel : available) names += (names.empty() ? "" : ", ") + channel;
  const std::string& scene_name = tables.scenes[at(scene)].name;
  if (available.empty()) {
    throw DatasetError(fmt::format("{}: no radar readings in sample_data.json", scene_name));
  }
  for (const std::string& channel : wanted) {
    if (std::find(available.begin(), available.end(), channel) == available.end()) {
      throw DatasetError(
          fmt::format("{}: channel '{}' is not one of its radars: {}", scene_name, channel, names));
    }
  }
  return wanted.empty() ? available : wanted;
}

LoadedRadar loadRadar(const Tables& tables, Index scene, const std::string& channel,
                      const ExtractionParams& extraction) {
  LoadedRadar radar;
  radar.channel = channel;
  DopplerExtractor extractor(extraction);
  for (const Index row : tables.readingsOf(scene, channel)) {
    const dataset::SampleData& reading = tables.sample_data[at(row)];
    const std::filesystem::path path = tables.path(reading);
    if (!std::filesystem::exists(path)) continue;  // a dataroot may hold only part of the sweeps
    LoadedScan scan;
    scan.time = 1e-6 * static_cast<double>(reading.timestamp_us);
    scan.sample = reading.sample;
    scan.is_key_frame = reading.is_key_frame;
    try {
      extractor.extract(dataset::readPcd(path).view(), scan.returns);
    } catch (const std::invalid_argument& error) {
      throw DatasetError(fmt::format("{}: {}", path.string(), error.what()));
    }
    radar.T_base_from_sensor = tables.calibrated_sensors[at(reading.calibrated_sensor)].T_base_from_sensor;
    radar.scans.push_back(std::move(scan));
  }
  return radar;
}

PoseTrack loadTruth(const Tables& tables, Index scene) {
  std::vector<StampedPose> poses;
  for (const Index row : tables.egoPosesOf(scene)) {
    const dataset::EgoPose& pose = tables.ego_poses[at(row)];
    poses.push_back({1e-6 * static_cast<double>(pose.timestamp_us), pose.T_map_from_base()});
  }
  try {
    return PoseTrack(std::move(poses));
  } catch (const std::invalid_argument& error) {
    throw DatasetError(fmt::format("ego_pose.json, {}: {}", tables.scenes[at(scene)].name, error.what()));
  }
}

}  // namespace

RadarScene loadRadarScene(const Tables& tables, Index scene, const std::vector<std::string>& channels,
                          const ExtractionParams& extraction) {
  std::vector<LoadedRadar> radars;
  std::size_t scans = 0;
  for (const std::string& channel : radarChannels(tables, scene, channels)) {
    radars.push_back(loadRadar(tables, scene, channel, extraction));
    scans += radars.back().scans.size();
  }
  const std::string& name = tables.scenes[at(scene)].name;
  if (scans == 0) {
    throw DatasetError(
        fmt::format("{}: none of its radar files is under {}", name, tables.dataroot().string()));
  }
  RadarScene result{std::move(radars),
                    {},
                    tables.samplesOf(scene),
                    loadTruth(tables, scene),
                    dataset::readCanBus(tables.dataroot(), name).vehicle};
  for (const Index sample : result.keyframe_samples) {
    result.keyframe_times.push_back(1e-6 * static_cast<double>(tables.samples[at(sample)].timestamp_us));
  }
  return result;
}

}  // namespace radar_dot::evaluation
