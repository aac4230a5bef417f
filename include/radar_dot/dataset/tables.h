// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "radar_dot/dataset/left_out.h"
#include "radar_dot/dataset/token.h"
#include "radar_dot/dataset/token_index.h"

namespace radar_dot::dataset {

/// Anything wrong with a dataset's files. The message is one line with file, record and field, and
/// how to correct it.
class DatasetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Row number in a table; kNone where the reference is empty.
using Index = std::int32_t;
inline constexpr Index kNone = -1;

/// The row of a table with this number.
template <typename Row>
const Row& at(const std::vector<Row>& rows, Index index) {
  return rows[static_cast<std::size_t>(index)];
}

enum class Modality : std::uint8_t { kCamera, kLidar, kRadar, kOther };

struct Sensor {
  Token token;
  std::string channel;  ///< e.g. "RADAR_FRONT"
  Modality modality = Modality::kOther;
};

struct CalibratedSensor {
  Token token;
  Index sensor = kNone;
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Matrix3d> camera_matrix;  ///< px; cameras only
};

struct EgoPose {
  Token token;
  std::int64_t timestamp_us = 0;
  std::array<double, 3> translation{};  ///< m, base origin in the map frame
  std::array<double, 4> rotation{};     ///< w x y z, map from base
  Eigen::Isometry3d T_map_from_base() const;
};

struct Log {
  Token token;
  std::string vehicle;  ///< "simulated" of simulated drives
};

struct Scene {
  Token token;
  std::string name;   ///< e.g. "scene-0061"
  Index log = kNone;  ///< kNone without a table of them
};

/// A keyframe.
struct Sample {
  Token token;
  std::int64_t timestamp_us = 0;
  Index scene = kNone;
};

/// One sensor reading. `Tables::filename` gives its path.
struct SampleData {
  Token token;
  std::int64_t timestamp_us = 0;
  Index sample = kNone;
  Index ego_pose = kNone;
  Index calibrated_sensor = kNone;
  Index previous = kNone;
  std::uint32_t filename_offset = 0;
  std::uint16_t filename_length = 0;
  std::uint16_t width = 0;   ///< px; cameras; 0 where the dataset does not say
  std::uint16_t height = 0;  ///< px
  bool is_key_frame = false;
};

struct Category {
  Token token;
  std::string name;  ///< e.g. "vehicle.car"
};

struct Attribute {
  Token token;
  std::string name;  ///< e.g. "vehicle.moving"
};

struct Instance {
  Token token;
  Index category = kNone;
};

/// An annotated box at a keyframe, map frame.
struct SampleAnnotation {
  Token token;
  Index sample = kNone;
  Index instance = kNone;
  Index previous = kNone;
  Index next = kNone;
  std::array<double, 3> translation{};  ///< m, centre
  std::array<double, 3> size{};         ///< m: width (y), length (x), height (z)
  std::array<double, 4> rotation{};     ///< w x y z
  std::vector<Index> attributes;
  Eigen::Isometry3d T_map_from_box() const;
};

/// What to read.
struct LoadOptions {
  std::string version = "v1.0-mini";
  /// Scene names; empty = all. Rows of other scenes are skipped while reading, which makes loading
  /// one scene of the full dataset cheap in memory: the tables then hold these scenes and nothing of
  /// any other (but all sensors, calibrations, logs and names).
  std::vector<std::string> scenes;
  bool annotations = true;  ///< sample_annotation and instance
};

/// The tables of a nuScenes dataroot, with every reference resolved to a row number.
class Tables {
 public:
  /// Reads `dataroot/version/*.json`, streaming. The table log, and fields that no reading or box needs, may
  /// be missing; those of map and visibility are not read.
  /// @throws DatasetError for a missing dataroot or table, malformed JSON (file and byte), a missing
  ///         or mistyped field (file, record, field), a reference to a token that does not exist
  ///         (file, record, field, token), a token used twice, or a scene name that does not exist (with the
  ///         names). Records are counted from 0.
  static Tables load(const std::filesystem::path& dataroot, const LoadOptions& options = {});

  const std::filesystem::path& dataroot() const noexcept { return dataroot_; }
  const std::string& version() const noexcept { return version_; }

  std::vector<Sensor> sensors;
  std::vector<CalibratedSensor> calibrated_sensors;
  std::vector<EgoPose> ego_poses;
  std::vector<Log> logs;
  std::vector<Scene> scenes;
  std::vector<Sample> samples;
  std::vector<SampleData> sample_data;
  std::vector<Category> categories;
  std::vector<Attribute> attributes;
  std::vector<Instance> instances;
  std::vector<SampleAnnotation> annotations;
  TokenPool tokens;
  LeftOut left_out;  ///< by whoever reads files of the dataroot

  /// Row of the scene, or kNone.
  Index findScene(std::string_view name) const noexcept;
  /// Keyframes of a scene in time order.
  std::vector<Index> samplesOf(Index scene) const;
  /// All readings of a channel in a scene, keyframes and sweeps, in time order.
  std::vector<Index> readingsOf(Index scene, std::string_view channel) const;
  /// Channels with at least one reading in the scene, sorted by name.
  std::vector<std::string> channelsOf(Index scene) const;
  /// Annotations of a keyframe.
  std::vector<Index> annotationsOf(Index sample) const;
  /// Ego poses used by the scene's readings, in time order, without repeated stamps.
  std::vector<Index> egoPosesOf(Index scene) const;

  const std::string& channelOf(const SampleData& reading) const;
  /// Path relative to the dataroot.
  std::string_view filename(const SampleData& reading) const noexcept;
  std::filesystem::path path(const SampleData& reading) const;
  /// Does the work on a scene. What is wrong with its files leaves it out instead of ending the others.
  /// @return whether it was done; what else goes wrong than the data passes through
  bool work(Index scene, const std::function<void()>& on_scene) const;
  /// To be called where no scene could be worked on. @throws DatasetError with the reason of the first
  [[noreturn]] void failWithoutScenes() const;

  /// Row of the reading with this token, or kNone.
  Index findReading(Token token) const noexcept;

 private:
  friend class TableLoader;
  void buildIndices();

  std::filesystem::path dataroot_;
  std::string version_;
  std::string filenames_;                                       ///< all file names, back to back
  TokenIndex reading_by_token_;                                 ///< of sample_data
  std::vector<std::pair<Index, Index>> readings_by_scene_;      ///< (scene, reading), sorted by scene, time
  std::vector<std::pair<Index, Index>> annotations_by_sample_;  ///< (sample, annotation), sorted
};

}  // namespace radar_dot::dataset
