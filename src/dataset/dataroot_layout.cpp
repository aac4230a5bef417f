// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "dataroot_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

namespace fs = std::filesystem;

namespace {

/// Those that are needed.
constexpr std::string_view kTables[] = {
    "attribute", "calibrated_sensor", "category",    "ego_pose", "instance",
    "sample",    "sample_annotation", "sample_data", "scene",    "sensor"};
constexpr std::size_t kMaxNames = 50;

/// Versions in a dataroot: its folders with a scene table.
std::vector<std::string> versionsIn(const fs::path& dataroot) {
  std::vector<std::string> versions;
  for (const fs::directory_entry& entry : fs::directory_iterator(dataroot))
    if (fs::exists(entry.path() / "scene.json")) versions.push_back(entry.path().filename().string());
  return versions;
}

}  // namespace

std::string sortedList(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMaxNames) text += fmt::format(" and {} more", names.size() - kMaxNames);
  return text.empty() ? "none" : text;
}

void requireTables(const fs::path& dataroot, const std::string& version, bool with_annotations) {
  if (!fs::is_directory(dataroot))
    throw DatasetError(fmt::format("dataroot {} does not exist or is no folder", dataroot.string()));
  if (version.empty() || !fs::is_directory(dataroot / version))
    throw DatasetError(fmt::format("dataroot {} holds no version '{}'; versions there: {}", dataroot.string(),
                                   version, sortedList(versionsIn(dataroot))));
  for (const std::string_view table : kTables) {
    if (!with_annotations && (table == "instance" || table == "sample_annotation")) continue;
    const std::string file = fmt::format("{}/{}.json", version, table);
    if (!fs::exists(dataroot / file))
      throw DatasetError(fmt::format(
          "{} is missing in {}; a nuScenes dataroot holds samples/, sweeps/ and {}/ with the tables {}", file,
          dataroot.string(), version, sortedList({std::begin(kTables), std::end(kTables)})));
  }
}

}  // namespace radar_dot::dataset
