// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause

// Writes tables as large as those of v1.0-trainval into a temporary folder and prints how long
// Tables::load takes and the most memory the program ever held: first for one scene, then for all.
// Needs about 2 GB of disk for the default size. Memory never goes down again, so the second figure
// is that of the full load.

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/dataset/tables.h"
#include "tools/command_line.h"

namespace {

namespace fs = std::filesystem;
using namespace radar_dot::dataset;

constexpr int kSamplesPerScene = 40;
constexpr std::int64_t kStart = 1'532'402'927'000'000;
const std::string kVersion = "v1.0-large";
const std::vector<std::string> kChannels = {"CAM_FRONT",         "CAM_FRONT_LEFT",  "CAM_FRONT_RIGHT",
                                            "CAM_BACK",          "CAM_BACK_LEFT",   "CAM_BACK_RIGHT",
                                            "RADAR_FRONT",       "LIDAR_TOP",       "RADAR_FRONT_LEFT",
                                            "RADAR_FRONT_RIGHT", "RADAR_BACK_LEFT", "RADAR_BACK_RIGHT"};

/// Distinct tokens that look like random ones (mixBits is a bijection).
std::string token(std::uint64_t kind, std::uint64_t number) {
  const std::uint64_t row = (kind << 40) + number;
  return fmt::format("{:016x}{:016x}", radar_dot::mixBits(row),
                     radar_dot::mixBits(row + (std::uint64_t{1} << 62)));
}
enum Kind : std::uint64_t { kSensor = 1, kCalibration, kLog, kScene, kSample, kReading, kPose };

/// A JSON list that is written record by record.
class TableFile {
 public:
  TableFile(const fs::path& dataroot, const char* table)
      : file_(std::fopen((dataroot / kVersion / (std::string(table) + ".json")).c_str(), "wb"),
              &std::fclose) {
    if (!file_) throw std::runtime_error("cannot write into " + dataroot.string());
    fmt::print(file_.get(), "[");
  }
  ~TableFile() { fmt::print(file_.get(), "\n]\n"); }
  void add(const std::string& record) {
    fmt::print(file_.get(), "{}\n{{\n{}\n}}", first_ ? "" : ",", record);
    first_ = false;
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  bool first_ = true;
};

void writeSmallTables(const fs::path& dataroot, std::uint64_t scenes) {
  for (const char* table : {"category", "attribute", "visibility", "map", "instance", "sample_annotation"})
    TableFile(dataroot, table);
  TableFile sensors(dataroot, "sensor"), calibrations(dataroot, "calibrated_sensor"), logs(dataroot, "log");
  logs.add(
      fmt::format(R"("token": "{}", "logfile": "a", "vehicle": "b", "date_captured": "c", "location": "d")",
                  token(kLog, 0)));
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    sensors.add(fmt::format(R"("token": "{}", "channel": "{}", "modality": "radar")", token(kSensor, i),
                            kChannels[i]));
    calibrations.add(fmt::format(
        R"("token": "{}", "sensor_token": "{}", "translation": [1, 2, 3], "rotation": [1, 0, 0, 0], )"
        R"("camera_intrinsic": [])",
        token(kCalibration, i), token(kSensor, i)));
  }
  TableFile scene_table(dataroot, "scene"), samples(dataroot, "sample");
  for (std::uint64_t scene = 0; scene < scenes; ++scene) {
    const std::uint64_t first = scene * kSamplesPerScene;
    const std::uint64_t last = first + kSamplesPerScene - 1;
    scene_table.add(
        fmt::format(R"("token": "{}", "log_token": "{}", "nbr_samples": {}, "first_sample_token": "{}", )"
                    R"("last_sample_token": "{}", "name": "scene-{:04}", "description": "")",
                    token(kScene, scene), token(kLog, 0), kSamplesPerScene, token(kSample, first),
                    token(kSample, last), scene));
    for (std::uint64_t i = first; i <= last; ++i)
      samples.add(
          fmt::format(R"("token": "{}", "timestamp": {}, "prev": "{}", "next": "{}", "scene_token": "{}")",
                      token(kSample, i), kStart + static_cast<std::int64_t>(i) * 500'000,
                      i == first ? "" : token(kSample, i - 1), i == last ? "" : token(kSample, i + 1),
                      token(kScene, scene)));
  }
}

void writeLargeTables(const fs::path& dataroot, std::uint64_t scenes, std::uint64_t rows) {
  TableFile sample_data(dataroot, "sample_data"), poses(dataroot, "ego_pose");
  const std::uint64_t channels = kChannels.size();
  const std::uint64_t per_scene = rows / scenes;
  for (std::uint64_t i = 0; i < rows; ++i) {
    const std::uint64_t scene = std::min(i / per_scene, scenes - 1);
    const std::uint64_t within = i - scene * per_scene;
    const std::uint64_t sample =
        scene * kSamplesPerScene +
        std::min<std::uint64_t>(within * kSamplesPerScene / per_scene, kSamplesPerScene - 1);
    const std::string& channel = kChannels[i % channels];
    const std::int64_t time_us = kStart + static_cast<std::int64_t>(i) * 6'000;
    const bool has_next = i + channels < rows;
    sample_data.add(
        fmt::format("\"token\": \"{}\",\n\"sample_token\": \"{}\",\n\"ego_pose_token\": "
                    "\"{}\",\n\"calibrated_sensor_token\": \"{}\",\n"
                    "\"timestamp\": {},\n\"fileformat\": \"pcd\",\n\"is_key_frame\": false,\n\"height\": "
                    "0,\n\"width\": 0,\n"
                    "\"filename\": \"sweeps/{}/n015-2018-07-24-11-22-45+0800__{}__{}.pcd\",\n\"prev\": "
                    "\"{}\",\n\"next\": \"{}\"",
                    token(kReading, i), token(kSample, sample), token(kPose, i),
                    token(kCalibration, i % channels), time_us, channel, channel, time_us,
                    i < channels || i % per_scene < channels ? "" : token(kReading, i - channels),
                    has_next && (i % per_scene) + channels < per_scene ? token(kReading, i + channels) : ""));
    poses.add(
        fmt::format("\"token\": \"{}\",\n\"timestamp\": {},\n\"rotation\": "
                    "[\n0.5720320396729045,\n-0.0016977771610471074,\n"
                    "0.011798001930183783,\n-0.8201446642457809\n],\n\"translation\": "
                    "[\n{:.13f},\n1180.7403791219309,\n0.0\n]",
                    token(kPose, i), time_us, 400.0 + 1e-3 * static_cast<double>(i)));
  }
}

double peakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void measure(const fs::path& dataroot, const std::vector<std::string>& scenes, const char* name) {
  LoadOptions options;
  options.version = kVersion;
  options.scenes = scenes;
  const auto start = std::chrono::steady_clock::now();
  const Tables tables = Tables::load(dataroot, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  fmt::print("{:<10} {:>9} sample_data {:>9} ego_pose {:>8.2f} s  peak {:>7.1f} MB\n", name,
             tables.sample_data.size(), tables.ego_poses.size(), elapsed.count(), peakMegabytes());
}

struct Arguments {
  std::uint64_t rows = 2'600'000, scenes = 850;
  std::string folder = (fs::temp_directory_path() / "radar_dot_large_tables").string();

  void describe(radar_dot::FieldList& fields) {
    fields.add("rows", rows, "Rows of sample_data and of ego_pose");
    fields.add("scenes", scenes, "Scenes the rows belong to");
    fields.add("folder", folder, "Where to write the tables; removed afterwards");
  }
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  radar_dot::tools::CommandLine command_line(
      "large_tables_benchmark",
      "Loads generated nuScenes tables of the size of v1.0-trainval; prints seconds and peak memory.",
      {"large_tables_benchmark", "large_tables_benchmark --rows 100000 --scenes 40"});
  command_line.add("Options", radar_dot::fieldsOf(arguments));
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  const std::uint64_t rows = arguments.rows, scenes = arguments.scenes;
  const std::string& folder = arguments.folder;
  const fs::path dataroot = folder;
  if (scenes == 0 || rows < 100 * scenes || fs::exists(dataroot)) {
    fmt::print(stderr,
               "needs 1 or more scenes, 100 or more rows a scene and a folder that does not exist: {}\n",
               folder);
    return 1;
  }
  try {
    fs::create_directories(dataroot / kVersion);
    writeSmallTables(dataroot, scenes);
    writeLargeTables(dataroot, scenes, rows);
    for (const char* table : {"sample_data", "ego_pose"})
      fmt::print("{}.json {} MB\n", table,
                 fs::file_size(dataroot / kVersion / (std::string(table) + ".json")) >> 20);
    measure(dataroot, {"scene-0000"}, "one scene");
    measure(dataroot, {}, "all scenes");
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    fs::remove_all(dataroot);
    return 1;
  }
  fs::remove_all(dataroot);
  return 0;
}
