// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_content.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <tuple>
#include <unordered_map>

namespace radar_dot::bag {
namespace {

using dataset::Index;
using dataset::Tables;

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The channels to convert: those of the scene that were asked for.
std::vector<std::string> chooseChannels(const Tables& tables, const std::vector<std::string>& available,
                                        const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const dataset::Sensor& sensor : tables.sensors) known.push_back(sensor.channel);
  std::sort(known.begin(), known.end());
  for (const std::string& channel : wanted) {
    if (!contains(known, channel)) {
      throw std::invalid_argument(
          fmt::format("unknown channel {}; the dataset has {}", channel, fmt::join(known, ", ")));
    }
  }
  std::vector<std::string> chosen;
  std::copy_if(available.begin(), available.end(), std::back_inserter(chosen),
               [&wanted](const std::string& channel) { return wanted.empty() || contains(wanted, channel); });
  return chosen;
}

/// Sorts the readings of the chosen channels into present and missing ones.
void collectReadings(const Tables& tables, Index scene, const std::vector<std::string>& channels,
                     SceneContent& content) {
  std::size_t listed = 0;
  for (const std::string& channel : channels) {
    FileCount count;
    for (const Index reading : tables.readingsOf(scene, channel)) {
      std::error_code ignored;
      ++count.listed;
      if (std::filesystem::exists(tables.path(at(tables.sample_data, reading)), ignored)) {
        content.readings.push_back(reading);
      } else {
        ++count.missing;
      }
    }
    listed += count.listed;
    if (count.missing > 0) content.missing[channel] = count;
  }
  const std::string& name = at(tables.scenes, scene).name;
  if (listed == 0) throw dataset::DatasetError(name + ": no reading of the chosen channels");
  if (content.readings.empty()) {
    throw dataset::DatasetError(fmt::format("{}: none of its {} sensor files is in {}; check the dataroot",
                                            name, listed, tables.dataroot().string()));
  }
}

void collectMasks(const Tables& tables, Index scene, const std::vector<std::string>& channels,
                  const std::vector<dataset::InstanceMask>& masks, SceneContent& content) {
  std::unordered_map<dataset::Token, Index> images;
  for (const std::string& channel : channels) {
    for (const Index reading : tables.readingsOf(scene, channel)) {
      const dataset::SampleData& row = at(tables.sample_data, reading);
      if (row.is_key_frame) images.emplace(row.token, reading);
    }
  }
  for (const dataset::InstanceMask& mask : masks) {
    const auto image = images.find(mask.sample_data_token);
    if (image != images.end()) content.masks[image->second].push_back(&mask);
  }
}

}  // namespace

SceneContent collectContent(const Tables& tables, Index scene, const ConvertOptions& options) {
  const std::vector<std::string> available = tables.channelsOf(scene);
  const std::vector<std::string> channels = chooseChannels(tables, available, options.channels);
  SceneContent content;
  collectReadings(tables, scene, channels, content);
  for (const std::string& channel : available) {
    content.mounts.push_back(tables.readingsOf(scene, channel).front());
  }
  content.poses = tables.egoPosesOf(scene);
  content.twists = egoTwists(tables, content.poses);
  content.can = dataset::readCanBus(tables.dataroot(), at(tables.scenes, scene).name, tables.left_out);
  if (!tables.annotations.empty()) content.keyframes = tables.samplesOf(scene);
  if (options.masks != nullptr) collectMasks(tables, scene, channels, *options.masks, content);
  return content;
}

std::vector<Event> schedule(const Tables& tables, const SceneContent& content) {
  std::vector<Event> events;
  events.reserve(content.readings.size() + content.poses.size() + content.can.imu.size() +
                 content.can.vehicle.size() + content.keyframes.size() + content.masks.size());
  const auto add = [&events](EventKind kind, std::size_t count, const auto& timeOf) {
    for (std::size_t i = 0; i < count; ++i) events.push_back({timeOf(i), kind, i});
  };
  add(EventKind::kReading, content.readings.size(),
      [&](std::size_t i) { return at(tables.sample_data, content.readings[i]).timestamp_us; });
  add(EventKind::kEgoPose, content.poses.size(),
      [&](std::size_t i) { return at(tables.ego_poses, content.poses[i]).timestamp_us; });
  add(EventKind::kImu, content.can.imu.size(),
      [&](std::size_t i) { return content.can.imu[i].timestamp_us; });
  add(EventKind::kWheelSpeed, content.can.vehicle.size(),
      [&](std::size_t i) { return content.can.vehicle[i].timestamp_us; });
  add(EventKind::kBoxes, content.keyframes.size(),
      [&](std::size_t i) { return at(tables.samples, content.keyframes[i]).timestamp_us; });
  for (const auto& [reading, instances] : content.masks) {
    events.push_back(
        {at(tables.sample_data, reading).timestamp_us, EventKind::kMask, static_cast<std::size_t>(reading)});
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tie(a.time_us, a.kind) < std::tie(b.time_us, b.kind);
  });
  return events;
}

}  // namespace radar_dot::bag
