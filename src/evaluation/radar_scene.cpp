// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "radar_dot/dataset/point_files.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"

namespace radar_dot::evaluation {
namespace {

using dataset::DatasetError;
using dataset::Index;
using dataset::Tables;

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
  const std::string& scene_name = tables.scenes[at(scene)].name;
  if (available.empty()) {
    throw DatasetError(fmt::format("{}: no radar readings in sample_data.json", scene_name));
  }
  for (const std::string& channel : wanted) {
    if (std::find(available.begin(), available.end(), channel) == available.end()) {
      throw DatasetError(fmt::format("{}: channel '{}' is not one of its radars: {}", scene_name, channel,
                                     fmt::join(available, ", ")));
    }
  }
  if (wanted.empty()) return available;
  std::vector<std::string> channels = wanted;
  std::sort(channels.begin(), channels.end());
  channels.erase(std::unique(channels.begin(), channels.end()), channels.end());
  return channels;
}

/// Times of the keyframes, s.
std::vector<double> keyframeTimes(const Tables& tables, Index scene, const PoseTrack& truth) {
  std::vector<double> times;
  const std::string& name = tables.scenes[at(scene)].name;
  bool covered = false;
  for (const Index row : tables.samplesOf(scene)) {
    const double time = secondsOf(tables.samples[at(row)].timestamp_us);
    if (!times.empty() && !(time > times.back())) {
      throw DatasetError(fmt::format(
          "sample.json, {}: two keyframes at {:.6f} s; each needs a time of its own", name, time));
    }
    covered = covered || truth.covers(time);
    times.push_back(time);
  }
  if (!covered) {
    throw DatasetError(
        fmt::format("ego_pose.json, {}: the poses cover {:.3f} to {:.3f} s, no keyframe lies within", name,
                    truth.begin(), truth.end()));
  }
  return times;
}

/// The channel of a topic: radar_front is RADAR_FRONT.
std::string channelOf(const std::string& topic) {
  std::string channel = topic.substr(topic.find_last_of('/') + 1);
  for (char& c : channel) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return channel;
}

LoadedRadar loadRadar(const Tables& tables, Index scene, const std::string& channel,
                      const EgoVelocityConfig& config) {
  LoadedRadar radar;
  radar.channel = channel;
  const RadarEntry entry = entryOf(config, channel).second;
  DopplerExtractor extractor(extractionOf(config, entry));
  for (const Index row : tables.readingsOf(scene, channel)) {
    const dataset::SampleData& reading = tables.sample_data[at(row)];
    ++radar.listed;
    const std::filesystem::path path = tables.path(reading);
    if (!std::filesystem::exists(path)) continue;  // a dataroot may hold only part of the sweeps
    LoadedScan scan;
    scan.time = secondsOf(reading) + entry.time_offset.value_or(0.0);
    scan.sample = reading.sample;
    scan.is_key_frame = reading.is_key_frame;
    const dataset::CalibratedSensor& sensor = tables.calibrated_sensors[at(reading.calibrated_sensor)];
    radar.T_base_from_sensor = corrected(mountOf(entry).value_or(sensor.T_base_from_sensor), entry);
    try {
      extractor.extract(dataset::readPcd(path).view(), scan.returns, &radar.T_base_from_sensor);
    } catch (const std::invalid_argument& error) {
      throw DatasetError(fmt::format("{}: {}", path.string(), error.what()));
    }
    radar.scans.push_back(std::move(scan));
  }
  return radar;
}

PoseTrack loadTruth(const Tables& tables, Index scene) {
  std::vector<StampedPose> poses;
  for (const Index row : tables.egoPosesOf(scene)) {
    const dataset::EgoPose& pose = tables.ego_poses[at(row)];
    poses.emplace_back(secondsOf(pose.timestamp_us), pose.T_map_from_base());
  }
  try {
    return PoseTrack(std::move(poses));
  } catch (const std::invalid_argument& error) {
    throw DatasetError(fmt::format("ego_pose.json, {}: {}", tables.scenes[at(scene)].name, error.what()));
  }
}

bool isMoreThanTopic(const RadarEntry& entry) {
  RadarEntry plain;
  plain.topic = entry.topic;
  const FieldList fields = fieldsOf(entry), plain_fields = fieldsOf(plain);
  return std::any_of(fields.begin(), fields.end(), [&plain_fields](const Field& field) {
    return !field.live_only && field.get() != plain_fields.find(field.name)->get();
  });
}

/// A correction for a radar that the scene does not have would be lost without a word.
void requireRadars(const Tables& tables, Index scene, const EgoVelocityConfig& config) {
  const std::vector<std::string> channels = radarChannels(tables, scene, {});
  for (const auto& [name, given] : config.radars) {
    const RadarEntry entry = withPreset(given);
    if (!isMoreThanTopic(entry) ||
        std::find(channels.begin(), channels.end(), channelOf(entry.topic)) != channels.end())
      continue;
    throw DatasetError(
        fmt::format("{}: the parameters of radars/{} are for the topic '{}', which is not one of {}",
                    tables.scenes[at(scene)].name, name, entry.topic, fmt::join(channels, ", ")));
  }
}

}  // namespace

std::pair<std::string, RadarEntry> entryOf(const EgoVelocityConfig& config, const std::string& channel) {
  std::string topic = channel;
  std::transform(topic.begin(), topic.end(), topic.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::pair<std::string, RadarEntry> found(topic, {});
  found.second.topic = topic;
  for (const auto& [name, given] : config.radars) {
    const RadarEntry whole = withPreset(given);
    if (channelOf(whole.topic) != channel) continue;
    found = {name, whole};
    found.second.preset = given.preset;
  }
  return found;
}

EgoVelocityConfig withMountCorrections(EgoVelocityConfig config,
                                       const std::vector<std::string>& corrections) {
  for (const std::string& text : corrections) {
    const std::size_t equals = text.find('=');
    char* end = nullptr;
    const double yaw = equals == std::string::npos ? 0.0 : std::strtod(text.c_str() + equals + 1, &end);
    if (end == nullptr || *end != '\0' || end == text.c_str() + equals + 1 || !std::isfinite(yaw))
      throw std::invalid_argument(fmt::format("mount_yaw_correction '{}' is not CHANNEL=RAD", text));
    const std::string channel = channelOf(text.substr(0, equals));
    const auto found = std::find_if(config.radars.begin(), config.radars.end(), [&](const auto& radar) {
      return channelOf(radar.second.topic) == channel;
    });
    RadarEntry& entry = found != config.radars.end() ? found->second : config.radars[channel];
    if (entry.topic.empty()) entry.topic = channel;
    fieldsOf(entry).of(&entry.mount_yaw_correction).set(yaw);
  }
  return config;
}

std::optional<std::size_t> nearestScan(const LoadedRadar& radar, double time, double reach) {
  const auto& scans = radar.scans;
  if (scans.empty()) return std::nullopt;
  auto best = std::lower_bound(scans.begin(), scans.end(), time,
                               [](const LoadedScan& scan, double t) { return scan.time < t; });
  if (best == scans.end() || (best != scans.begin() && time - std::prev(best)->time < best->time - time))
    --best;
  if (std::abs(best->time - time) > reach) return std::nullopt;
  return static_cast<std::size_t>(best - scans.begin());
}

RadarScene loadRadarScene(const Tables& tables, Index scene, const std::vector<std::string>& channels,
                          const EgoVelocityConfig& config) {
  requireRadars(tables, scene, config);
  std::vector<LoadedRadar> radars;
  std::size_t scans = 0;
  std::string missing;
  for (const std::string& channel : radarChannels(tables, scene, channels)) {
    radars.push_back(loadRadar(tables, scene, channel, config));
    radars.back().number = radars.size() - 1;
    scans += radars.back().scans.size();
    if (const std::size_t lacks = radars.back().listed - radars.back().scans.size(); lacks > 0)
      missing +=
          fmt::format("{}{} {} of {}", missing.empty() ? "" : ", ", channel, lacks, radars.back().listed);
    if (!channels.empty() && radars.back().scans.empty()) {
      throw dataset::DatasetError(fmt::format("{}: none of the {} files of {} is under {}",
                                              tables.scenes[at(scene)].name, radars.back().listed, channel,
                                              tables.dataroot().string()));
    }
  }
  const std::string& name = tables.scenes[at(scene)].name;
  if (scans == 0) {
    throw dataset::DatasetError(
        fmt::format("{}: none of its radar files is under {}", name, tables.dataroot().string()));
  }
  if (!missing.empty()) tables.left_out.add(name + " (radar files)", "not on disk: " + missing);
  PoseTrack truth = loadTruth(tables, scene);
  std::vector<double> times = keyframeTimes(tables, scene, truth);
  return {std::move(radars),
          std::move(times),
          tables.samplesOf(scene),
          std::move(truth),
          dataset::readVehicleInfo(tables.dataroot(), name, tables.left_out),
          config};
}

}  // namespace radar_dot::evaluation
