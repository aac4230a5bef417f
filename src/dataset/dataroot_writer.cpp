// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/dataroot_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "json_table_writer.h"
#include "new_token.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/tables.h"
#include "scene_checks.h"
#include "scene_rows.h"
#include "staged_folder.h"
#include "vocabulary.h"

namespace radar_dot::dataset {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 5> kDataFolders = {"can_bus", "ground_truth", "maps", "samples",
                                                          "sweeps"};

/// A PNG of one black pixel.
constexpr unsigned char kPlaceholderMap[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0x00, 0x00, 0x00, 0x02, 0x00, 0x01,
    0xe5, 0x27, 0xde, 0xfc, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/// The tokens of categories tell our dataroots from those of others.
bool hasOwnCategories(const fs::path& version_folder) {
  std::ifstream file(version_folder / "category.json");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.find(categoryToken("vehicle.car")) != std::string::npos;
}

/// @throws DatasetError unless the folder is a dataroot of this version that a DatarootWriter made.
void requireOwnDataroot(const fs::path& folder, const std::string& version) {
  const auto refuse = [&](const std::string& reason) {
    throw DatasetError(fmt::format("{}: is not replaced, because it {}; name another folder or delete it",
                                   folder.string(), reason));
  };
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_known =
        name == version || std::find(kDataFolders.begin(), kDataFolders.end(), name) != kDataFolders.end();
    if (!is_known || entry.symlink_status().type() != fs::file_type::directory)
      refuse(
          fmt::format("holds '{}', which is no part of a simulated dataroot of version '{}'", name, version));
  }
  if (!hasOwnCategories(folder / version))
    refuse(fmt::format("is no simulated dataroot of version '{}'", version));
}

const std::string& checkVersion(const std::string& version) {
  if (!isPlainName(version) ||
      std::find(kDataFolders.begin(), kDataFolders.end(), version) != kDataFolders.end())
    throw std::invalid_argument(
        fmt::format("the version '{}' must be a plain folder name, such as v1.0-sim", version));
  return version;
}

StagedFolder::Guard guardOf(const std::string& version, bool overwrite) {
  return [version, overwrite](const fs::path& folder) {
    if (!overwrite)
      throw DatasetError(fmt::format("{}: exists and is not empty; --force replaces it", folder.string()));
    requireOwnDataroot(folder, version);
  };
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error)
    throw DatasetError(fmt::format("{}: cannot make this folder: {}", folder.string(), error.message()));
}

}  // namespace

class DatarootWriter::Content {
 public:
  Content(const fs::path& output, const std::string& version, bool overwrite)
      : folder_(output, guardOf(checkVersion(version), overwrite)),
        version_folder_(folder_.path() / version) {
    for (const char* name : {"can_bus", "maps", "samples", "sweeps"}) makeFolder(folder_.path() / name);
    makeFolder(version_folder_);
    tables_ = std::make_unique<SceneTables>(version_folder_);
  }

  const fs::path& path() const noexcept { return folder_.path(); }

  void add(const NewScene& scene) {
    requireUsable();
    checkScene(scene);
    checkAgainstOthers(scene);
    is_usable_ = false;  // should any of this fail, half a scene is in the tables
    scenes_.insert(scene.name);
    logs_by_location_[scene.location].push_back(scene.log_name);
    logs_.insert(scene.log_name);
    for (const NewSensor& sensor : scene.sensors) modalities_[sensor.channel] = sensor.modality;
    for (const NewReading& reading : scene.readings) filenames_.insert(reading.filename);
    writeSceneRows(scene, *tables_);
    writeCanBus(folder_.path(), scene.name, scene.can_bus);
    is_usable_ = true;
  }

  void finish() {
    requireUsable();
    is_usable_ = false;
    tables_->finish();
    writeVocabulary(version_folder_);
    writeSensors();
    writeMaps();
    folder_.commit();
  }

 private:
  void requireUsable() const {
    if (!is_usable_) throw std::logic_error("the dataroot is finished, or writing it has failed");
  }

  void checkAgainstOthers(const NewScene& scene) const {
    const auto fail = [&](const std::string& complaint) {
      throw std::invalid_argument(fmt::format("scene '{}': {}", scene.name, complaint));
    };
    if (scenes_.count(scene.name) != 0) fail("another scene has this name");
    if (logs_.count(scene.log_name) != 0) fail(fmt::format("another scene has the log '{}'", scene.log_name));
    for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
      const auto known = modalities_.find(scene.sensors[i].channel);
      if (known != modalities_.end() && known->second != scene.sensors[i].modality)
        fail(fmt::format("sensor {}: {} is a {} in another scene", i, known->first, known->second));
    }
    for (std::size_t i = 0; i < scene.readings.size(); ++i)
      if (filenames_.count(scene.readings[i].filename) != 0)
        fail(fmt::format("reading {}: a reading of another scene has this file name", i));
  }

  void writeSensors() const {
    JsonTableWriter table(version_folder_ / "sensor.json");
    for (const auto& [channel, modality] : modalities_)
      table.record().set("token", sensorToken(channel)).set("channel", channel).set("modality", modality);
    table.finish();
  }

  /// As in nuScenes, a location has one map for all of its logs.
  void writeMaps() const {
    JsonTableWriter table(version_folder_ / "map.json");
    for (const auto& [location, logs] : logs_by_location_) {
      const std::string token = newToken({"map", location});
      const std::string filename = "maps/" + token + ".png";
      std::vector<std::string> log_tokens;
      for (const std::string& log : logs) log_tokens.push_back(logToken(log));
      table.record()
          .set("category", "semantic_prior")
          .set("token", token)
          .set("filename", filename)
          .set("log_tokens", log_tokens);
      writeBytes(folder_.path() / filename, kPlaceholderMap, sizeof kPlaceholderMap);
    }
    table.finish();
  }

  StagedFolder folder_;
  fs::path version_folder_;
  std::unique_ptr<SceneTables> tables_;
  bool is_usable_ = true;
  std::set<std::string> scenes_, logs_;  ///< names
  std::unordered_set<std::string> filenames_;
  std::map<std::string, std::string> modalities_;                     ///< by channel
  std::map<std::string, std::vector<std::string>> logs_by_location_;  ///< names
};

DatarootWriter::DatarootWriter(const fs::path& output, const std::string& version, bool overwrite)
    : content_(std::make_unique<Content>(output, version, overwrite)) {}

DatarootWriter::~DatarootWriter() = default;

fs::path DatarootWriter::workFolder() const { return content_->path(); }

void DatarootWriter::add(const NewScene& scene) { content_->add(scene); }

void DatarootWriter::finish() { content_->finish(); }

}  // namespace radar_dot::dataset
