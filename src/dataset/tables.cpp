// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <tuple>

namespace radar_dot::dataset {
namespace {

Eigen::Isometry3d poseOf(const std::array<double, 3>& translation, const std::array<double, 4>& rotation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << translation[0], translation[1], translation[2];
  pose.linear() =
      Eigen::Quaterniond(rotation[0], rotation[1], rotation[2], rotation[3]).normalized().toRotationMatrix();
  return pose;
}

using Pairs = std::vector<std::pair<Index, Index>>;

/// The range of pairs whose first is `key`, in a vector sorted by first.
std::pair<Pairs::const_iterator, Pairs::const_iterator> rangeOf(const Pairs& pairs, Index key) {
  struct ByFirst {
    bool operator()(const std::pair<Index, Index>& pair, Index value) const { return pair.first < value; }
    bool operator()(Index value, const std::pair<Index, Index>& pair) const { return value < pair.first; }
  };
  return std::equal_range(pairs.begin(), pairs.end(), key, ByFirst{});
}

template <typename Row>
Index sizeOf(const std::vector<Row>& rows) {
  return static_cast<Index>(rows.size());
}

}  // namespace

Eigen::Isometry3d EgoPose::T_map_from_base() const { return poseOf(translation, rotation); }

Eigen::Isometry3d SampleAnnotation::T_map_from_box() const { return poseOf(translation, rotation); }

void Tables::buildIndices() {
  readings_by_scene_.clear();
  readings_by_scene_.reserve(sample_data.size());
  for (Index i = 0; i < sizeOf(sample_data); ++i)
    readings_by_scene_.emplace_back(at(samples, at(sample_data, i).sample).scene, i);
  std::sort(readings_by_scene_.begin(), readings_by_scene_.end(), [this](const auto& a, const auto& b) {
    return std::make_tuple(a.first, at(sample_data, a.second).timestamp_us, a.second) <
           std::make_tuple(b.first, at(sample_data, b.second).timestamp_us, b.second);
  });
  annotations_by_sample_.clear();
  annotations_by_sample_.reserve(annotations.size());
  for (Index i = 0; i < sizeOf(annotations); ++i)
    annotations_by_sample_.emplace_back(at(annotations, i).sample, i);
  std::sort(annotations_by_sample_.begin(), annotations_by_sample_.end());
}

Index Tables::findScene(std::string_view name) const noexcept {
  for (Index i = 0; i < sizeOf(scenes); ++i)
    if (at(scenes, i).name == name) return i;
  return kNone;
}

std::vector<Index> Tables::samplesOf(Index scene) const {
  std::vector<Index> found;
  for (Index i = 0; i < sizeOf(samples); ++i)
    if (at(samples, i).scene == scene) found.push_back(i);
  std::sort(found.begin(), found.end(), [this](Index a, Index b) {
    return std::make_pair(at(samples, a).timestamp_us, a) < std::make_pair(at(samples, b).timestamp_us, b);
  });
  return found;
}

std::vector<Index> Tables::readingsOf(Index scene, std::string_view channel) const {
  std::vector<Index> found;
  const auto [first, last] = rangeOf(readings_by_scene_, scene);
  for (auto entry = first; entry != last; ++entry)
    if (channelOf(at(sample_data, entry->second)) == channel) found.push_back(entry->second);
  return found;
}

std::vector<std::string> Tables::channelsOf(Index scene) const {
  std::vector<bool> seen(sensors.size(), false);
  const auto [first, last] = rangeOf(readings_by_scene_, scene);
  for (auto entry = first; entry != last; ++entry) {
    const Index calibration = at(sample_data, entry->second).calibrated_sensor;
    seen[static_cast<std::size_t>(at(calibrated_sensors, calibration).sensor)] = true;
  }
  std::vector<std::string> channels;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    if (seen[i]) channels.push_back(sensors[i].channel);
  std::sort(channels.begin(), channels.end());
  return channels;
}

std::vector<Index> Tables::annotationsOf(Index sample) const {
  std::vector<Index> found;
  const auto [first, last] = rangeOf(annotations_by_sample_, sample);
  for (auto entry = first; entry != last; ++entry) found.push_back(entry->second);
  return found;
}

std::vector<Index> Tables::egoPosesOf(Index scene) const {
  std::vector<Index> found;
  const auto [first, last] = rangeOf(readings_by_scene_, scene);
  for (auto entry = first; entry != last; ++entry) found.push_back(at(sample_data, entry->second).ego_pose);
  std::sort(found.begin(), found.end(), [this](Index a, Index b) {
    return std::make_pair(at(ego_poses, a).timestamp_us, a) <
           std::make_pair(at(ego_poses, b).timestamp_us, b);
  });
  const auto same_stamp = [this](Index a, Index b) {
    return at(ego_poses, a).timestamp_us == at(ego_poses, b).timestamp_us;
  };
  found.erase(std::unique(found.begin(), found.end(), same_stamp), found.end());
  return found;
}

const std::string& Tables::channelOf(const SampleData& reading) const {
  return at(sensors, at(calibrated_sensors, reading.calibrated_sensor).sensor).channel;
}

std::string_view Tables::filename(const SampleData& reading) const noexcept {
  return {filenames_.data() + reading.filename_offset, reading.filename_length};
}

std::filesystem::path Tables::path(const SampleData& reading) const { return dataroot_ / filename(reading); }

bool Tables::work(Index scene, const std::function<void()>& on_scene) const {
  const std::string& name = at(scenes, scene).name;
  try {
    on_scene();
    return true;
  } catch (const DatasetError& error) {
    left_out.add(name, error.what());
  } catch (const cv::Exception& error) {
    left_out.add(name, error.what());
  }
  return false;
}

void Tables::failWithoutScenes() const {
  const std::map<std::string, std::string> reasons = left_out.entries();
  std::string text = fmt::format("{}: no scene", dataroot_.string());
  for (const Scene& scene : scenes) {
    const auto reason = reasons.find(scene.name);
    if (reason == reasons.end()) continue;
    text = fmt::format("{}: {}", scene.name, reason->second);
    if (scenes.size() > 1) text += fmt::format("; none of the {} scenes can be used", scenes.size());
    break;
  }
  throw DatasetError(text);
}

Index Tables::findReading(Token token) const noexcept { return reading_by_token_.find(sample_data, token); }

}  // namespace radar_dot::dataset
