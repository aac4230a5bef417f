// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <ros/header.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "fixtures/nuscenes_fixture.h"
#include "fuzz/fuzz_input.h"
#include "fuzz/fuzz_targets.h"
#include "radar_dot/bag/bag_input.h"
#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/point_files.h"

/// In place of that of ROS, which reads beyond its memory where the length of a field is wrong (cpp_common
/// 0.7.2): a defect that is not ours to mend, and would end every run on bags.
bool ros::Header::parse(std::uint8_t* buffer, std::uint32_t size, std::string& error) {
  for (std::uint32_t position = 0; position < size;) {
    std::uint32_t length = 0;
    if (size - position < sizeof length) return error = "no length", false;
    std::memcpy(&length, buffer + position, sizeof length);
    position += sizeof length;
    if (length > size - position) return error = "too long a field", false;
    const std::string field(reinterpret_cast<const char*>(buffer + position), length);
    const std::size_t sign = field.find('=');
    if (sign == std::string::npos) return error = "no equals sign", false;
    (*read_map_)[field.substr(0, sign)] = field.substr(sign + 1);
    position += length;
  }
  return true;
}

namespace radar_dot::test {
namespace {

using dataset::DatasetError;

std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

void expectWhole(const PointCloud& cloud) { expect(cloud.data.size() == cloud.size * cloud.point_step); }

/// The tables of two scenes, one of which each input replaces.
const NuscenesFixture& fixture() {
  static const NuscenesFixture made(FixtureOptions::tablesOnly());
  return made;
}

bool isMask(const cv::Mat& mask) {
  return mask.empty() || (mask.type() == CV_8UC1 && cv::countNonZero((mask != 0) & (mask != 255)) == 0);
}

}  // namespace

void fuzzPcd(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.set(textOf(data, size));
  mayRefuse<DatasetError>([] { expectWhole(dataset::readPcd(file.path())); });
  mayRefuse<DatasetError>([] { expectWhole(dataset::readRadarPcd(file.path())); });
}

void fuzzLidar(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.set(textOf(data, size));
  mayRefuse<DatasetError>([] { expectWhole(dataset::readLidarBin(file.path())); });
}

void fuzzTables(const std::uint8_t* data, std::size_t size) {
  constexpr std::array kTables = {
      "attribute", "calibrated_sensor", "category",    "ego_pose", "instance", "log",       "map",
      "sample",    "sample_annotation", "sample_data", "scene",    "sensor",   "visibility"};
  FuzzInput input(data, size);
  const std::filesystem::path table = fixture().table(kTables[input.number<std::uint8_t>() % kTables.size()]);
  const std::string sound = readFile(table);
  writeFile(table, input.rest());
  mayRefuse<DatasetError>([] {
    const dataset::Tables tables = dataset::Tables::load(fixture().dataroot());
    for (const dataset::SampleData& reading : tables.sample_data) {
      expect(reading.sample >= 0 && static_cast<std::size_t>(reading.sample) < tables.samples.size());
      expect(reading.ego_pose >= 0 && static_cast<std::size_t>(reading.ego_pose) < tables.ego_poses.size());
      expect(at(tables.ego_poses, reading.ego_pose).T_map_from_base().matrix().allFinite());
      static_cast<void>(tables.filename(reading));
    }
    for (const dataset::SampleAnnotation& box : tables.annotations)
      expect(box.T_map_from_box().matrix().allFinite());
  });
  writeFile(table, sound);
}

void fuzzCanBus(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  constexpr std::array kParts = {"pose", "ms_imu", "zoe_veh_info"};
  FuzzInput input(data, size);
  const std::string part = kParts[input.number<std::uint8_t>() % kParts.size()];
  const std::filesystem::path file = folder.path() / "can_bus" / ("scene-0001_" + part + ".json");
  writeFile(file, input.rest());
  mayRefuse<DatasetError>([] {
    const dataset::CanBus can_bus = dataset::readCanBus(folder.path(), "scene-0001");
    const auto earlier = [](const auto& a, const auto& b) { return a.timestamp_us < b.timestamp_us; };
    expect(std::is_sorted(can_bus.poses.begin(), can_bus.poses.end(), earlier));
    expect(std::is_sorted(can_bus.imu.begin(), can_bus.imu.end(), earlier));
    for (const dataset::CanVehicleInfo& info : can_bus.vehicle) expect(std::isfinite(rearAxleSpeed(info)));
  });
  std::filesystem::remove(file);
}

void fuzzRunLengths(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  constexpr int kLargest = 1000;  // for many inputs a second
  const int rows = input.number<std::int16_t>() % kLargest, columns = input.number<std::int16_t>() % kLargest;
  mayRefuse<std::invalid_argument>([&] {
    const dataset::RunLengthMask mask = dataset::parseRunLengths(input.rest(), rows, columns);
    const cv::Mat image = dataset::decodeMask(mask);
    expect(image.rows == rows && image.cols == columns && isMask(image));
    const cv::Mat again = dataset::decodeMask(
        dataset::parseRunLengths(dataset::formatRunLengths(dataset::encodeMask(image)), rows, columns));
    expect(again.size() == image.size() && (image.empty() || cv::countNonZero(image != again) == 0));
  });
}

void fuzzInstanceMasks(const std::uint8_t* data, std::size_t size) {
  static const dataset::Tables loaded = dataset::Tables::load(fixture().dataroot());
  static InputFile file;
  file.set(textOf(data, size));
  dataset::Tables tables = loaded;
  mayRefuse<DatasetError>([&] {
    const std::vector<dataset::InstanceMask> masks = dataset::readInstanceMasks(tables, file.path());
    for (const auto& scene : byScene(tables, masks)) {
      for (const dataset::InstanceMask* mask : scene) expect(isMask(decodeMask(*mask)));
      // Those of one image, as the evaluation asks.
      if (!scene.empty()) expect(isMask(dynamicMask(tables, {scene.front()})));
    }
  });
}

void fuzzBag(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.set(textOf(data, size));
  mayRefuse<std::runtime_error>([] {
    const bag::BagInput input({file.path()});
    input.read({}, [](const rosbag::MessageInstance& message) {
      std::vector<std::uint8_t> bytes(message.size());
      ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
      message.write(stream);
    });
  });
}

}  // namespace radar_dot::test
