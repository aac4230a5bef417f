// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/drive_simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <stdexcept>
#include <string>

#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/simulation/scenario.h"

namespace radar_dot::simulation {
namespace {

namespace fs = std::filesystem;
using dataset::Index;
using dataset::Tables;

DriveOptions smallDrive() {
  DriveOptions options;
  options.duration_s = 1.0;
  options.width = 320;
  options.height = 180;
  options.lidar_rate = 2.0;
  options.lidar.azimuth_steps = 180;
  return options;
}

void simulate(const fs::path& output, const DriveOptions& options,
              const std::vector<std::string>& scenarios) {
  dataset::DatarootWriter writer(output, "v1.0-sim", false);
  std::size_t number = 0;
  for (const std::string& name : scenarios)
    writer.add(simulateDrive(makeScenario(name, options.duration_s, options.seed), options, number++,
                             writer.workFolder()));
  writer.finish();
}

Tables loadSimulated(const fs::path& dataroot) { return Tables::load(dataroot, {"v1.0-sim", {}}); }

std::map<std::string, std::string> filesUnder(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder)] = test::readFile(entry.path());
  return files;
}

class DriveSimulator : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    simulate(dataroot(), smallDrive(), {"crossing", "standing"});
  }
  static fs::path dataroot() { return folder_->path() / "simulated"; }
  static Tables load() { return loadSimulated(dataroot()); }
  static inline std::unique_ptr<test::TemporaryFolder> folder_;
};

TEST_F(DriveSimulator, TablesAreReadAndEveryFileIsThere) {
  const Tables tables = load();
  ASSERT_EQ(tables.scenes.size(), 2U);
  EXPECT_EQ(tables.samplesOf(0).size(), 3U);
  EXPECT_GT(tables.annotations.size(), 10U);
  for (const auto& reading : tables.sample_data) EXPECT_TRUE(fs::is_regular_file(tables.path(reading)));
  const std::set<std::string> channels = {"CAM_FRONT",        "LIDAR_TOP",   "RADAR_BACK_LEFT",
                                          "RADAR_BACK_RIGHT", "RADAR_FRONT", "RADAR_FRONT_LEFT",
                                          "RADAR_FRONT_RIGHT"};
  const auto found = tables.channelsOf(0);
  EXPECT_EQ(std::set<std::string>(found.begin(), found.end()), channels);
}

TEST_F(DriveSimulator, RatesAreThoseOfTheCar) {
  const Tables tables = load();
  EXPECT_EQ(tables.readingsOf(0, "CAM_FRONT").size(), 14U) << "12 Hz over a second, both ends, and one after";
  EXPECT_EQ(tables.readingsOf(0, "LIDAR_TOP").size(), 3U);
  const auto scans = tables.readingsOf(0, "RADAR_FRONT");
  EXPECT_NEAR(static_cast<double>(scans.size()), 14.0, 1.0);
  std::map<std::int64_t, int> stamps;  // modulo the period: five radars, five phases
  for (const char* channel : {"RADAR_FRONT", "RADAR_FRONT_LEFT", "RADAR_BACK_RIGHT"})
    ++stamps[tables.sample_data[static_cast<std::size_t>(tables.readingsOf(0, channel)[3])].timestamp_us];
  EXPECT_EQ(stamps.size(), 3U) << "not synchronised";
}

TEST_F(DriveSimulator, EveryKeyframeHasEverySensor) {
  const Tables tables = load();
  std::map<Index, std::set<std::string>> keyframes;
  for (const auto& reading : tables.sample_data)
    if (reading.is_key_frame) {
      EXPECT_TRUE(keyframes[reading.sample].insert(tables.channelOf(reading)).second);
    }
  ASSERT_EQ(keyframes.size(), 6U);
  for (const auto& [sample, channels] : keyframes) EXPECT_EQ(channels.size(), 7U);
}

TEST_F(DriveSimulator, MasksAreTheGroundTruthOfKeyframes) {
  Tables tables = load();
  const auto masks = dataset::readInstanceMasks(tables);
  ASSERT_FALSE(masks.empty());
  int compared = 0;
  for (const Index row : tables.readingsOf(0, "CAM_FRONT")) {
    const auto& reading = tables.sample_data[static_cast<std::size_t>(row)];
    if (!reading.is_key_frame) continue;
    std::vector<const dataset::InstanceMask*> of_image;
    for (const auto& mask : masks)
      if (mask.sample_data_token == reading.token) of_image.push_back(&mask);
    ASSERT_FALSE(of_image.empty());
    const std::string stem = fs::path(std::string(tables.filename(reading))).stem();
    const cv::Mat motion =
        cv::imread((dataroot() / "ground_truth/motion" / (stem + ".png")).string(), cv::IMREAD_UNCHANGED);
    // Masks of a handful of pixels are left out of nuinsseg.json.
    EXPECT_LT(cv::countNonZero(dataset::dynamicMask(tables, of_image) != motion), 60);
    compared += cv::countNonZero(motion);
  }
  EXPECT_GT(compared, 100) << "something moves";
}

TEST_F(DriveSimulator, GroundTruthGoesWithTheImages) {
  const Tables tables = load();
  const auto readings = tables.readingsOf(0, "CAM_FRONT");
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const auto& reading = tables.sample_data[static_cast<std::size_t>(readings[i])];
    const std::string name = fs::path(std::string(tables.filename(reading))).stem().string() + ".png";
    const fs::path truth = dataroot() / "ground_truth";
    for (const char* kind : {"depth", "instance", "motion"}) EXPECT_TRUE(fs::exists(truth / kind / name));
    const bool has_next = i + 1 < readings.size();
    EXPECT_EQ(fs::exists(truth / "flow" / name), has_next);
    EXPECT_EQ(fs::exists(truth / "occlusion" / name), has_next);
    EXPECT_EQ(fs::exists(truth / "keyframe_flow" / name), reading.is_key_frame && reading.sample < 2);
  }
}

TEST_F(DriveSimulator, InstanceImagesCanBeJoinedWithTheTables) {
  const Tables tables = load();
  const std::string names =
      test::readFile(dataroot() / "ground_truth" / (tables.scenes[0].name + "_instances.json"));
  const Index row = tables.readingsOf(0, "CAM_FRONT").front();
  const std::string stem = tables.path(tables.sample_data[static_cast<std::size_t>(row)]).stem();
  const cv::Mat actors =
      cv::imread((dataroot() / "ground_truth/instance" / (stem + ".png")).string(), cv::IMREAD_UNCHANGED);
  std::map<std::uint16_t, int> pixels;
  for (const std::uint16_t actor : cv::Mat_<std::uint16_t>(actors)) ++pixels[actor];
  std::ptrdiff_t joined = 0;
  for (const auto& [actor, count] : pixels) {
    if (actor == 0 || count < 20) continue;
    const std::string key = "\"" + std::to_string(actor) + "\": \"";
    const std::size_t place = names.find(key);
    ASSERT_NE(place, std::string::npos) << actor;
    const dataset::Token token = tables.tokens.find(names.substr(place + key.size(), 32));
    joined += std::count_if(tables.instances.begin(), tables.instances.end(),
                            [&](const dataset::Instance& instance) { return instance.token == token; });
  }
  EXPECT_GT(joined, 2);
}

TEST_F(DriveSimulator, CanBusAgreesWithThePoses) {
  const dataset::CanBus can_bus = dataset::readCanBus(dataroot(), load().scenes[0].name);
  ASSERT_GT(can_bus.poses.size(), 50U);
  ASSERT_GT(can_bus.vehicle.size(), 100U);
  const auto& first = can_bus.poses[10];
  const auto& last = can_bus.poses[40];
  const double seconds = 1e-6 * static_cast<double>(last.timestamp_us - first.timestamp_us);
  const double displacement =
      std::hypot(last.position[0] - first.position[0], last.position[1] - first.position[1]);
  double wheels = 0.0;
  int count = 0;
  for (const auto& info : can_bus.vehicle) {
    if (info.timestamp_us < first.timestamp_us || info.timestamp_us > last.timestamp_us) continue;
    wheels += dataset::rearAxleSpeed(info);
    ++count;
  }
  EXPECT_NEAR(wheels / count, displacement / seconds, 0.05);
  double gravity = 0.0;
  for (const auto& imu : can_bus.imu) gravity += imu.linear_acceleration[2];
  EXPECT_NEAR(gravity / static_cast<double>(can_bus.imu.size()), 9.81, 0.2);
}

TEST(DriveSimulatorBytes, AreTheSameWithOneAndTwoThreadsAndChangeWithTheSeed) {
  const test::TemporaryFolder folder;
  DriveOptions options = smallDrive();
  options.duration_s = 0.5;
  options.width = 160;
  options.height = 90;
  options.threads = 1;
  simulate(folder.path() / "one", options, {"night"});
  options.threads = 2;
  simulate(folder.path() / "two", options, {"night"});
  options.seed = 2;
  simulate(folder.path() / "other", options, {"night"});
  const auto one = filesUnder(folder.path() / "one");
  const auto two = filesUnder(folder.path() / "two");
  ASSERT_GT(one.size(), 40U);
  ASSERT_EQ(one.size(), two.size());
  for (const auto& [name, bytes] : one) EXPECT_TRUE(two.at(name) == bytes) << name;
  EXPECT_NE(one, filesUnder(folder.path() / "other"));
}

TEST(DriveVariants, PairsOfSixCamerasWithoutOtherSensors) {
  const test::TemporaryFolder folder;
  DriveOptions options = smallDrive();
  options.duration_s = 0.5;
  options.width = 161;
  options.height = 91;
  options.cameras.clear();
  for (const CameraMount& mount : cameraMounts()) options.cameras.push_back(mount.channel);
  options.frames = CameraFrames::kPairs;
  options.radar_rate = 0.0;
  options.lidar_rate = 0.0;
  simulate(folder.path() / "drive", options, {"pedestrians"});
  Tables tables = loadSimulated(folder.path() / "drive");
  EXPECT_EQ(tables.channelsOf(0).size(), 6U);
  EXPECT_EQ(tables.sample_data.size(), 6U * 4U) << "two keyframes, and the image after each";
  const fs::path truth = folder.path() / "drive/ground_truth";
  for (const Index row : tables.readingsOf(0, "CAM_FRONT")) {
    const auto& reading = tables.sample_data[static_cast<std::size_t>(row)];
    const std::string name = tables.path(reading).stem().string() + ".png";
    EXPECT_EQ(cv::imread(tables.path(reading).string()).size(), cv::Size(161, 91));
    EXPECT_EQ(fs::exists(truth / "flow" / name), reading.is_key_frame);
    EXPECT_EQ(fs::exists(truth / "keyframe_flow" / name), reading.is_key_frame && reading.sample == 0);
    EXPECT_TRUE(fs::exists(truth / "depth" / name));
  }
  EXPECT_FALSE(dataset::readInstanceMasks(tables).empty()) << "annotated by its masks alone";
}

TEST(DriveVariants, SlowestSensorsAreCoveredByTheCanBus) {
  const test::TemporaryFolder folder;
  DriveOptions options = smallDrive();
  options.camera_rate = 2.0;
  options.radar_rate = 2.0;
  options.ground_truth = GroundTruth::kNone;
  simulate(folder.path() / "drive", options, {"standing"});
  const Tables tables = loadSimulated(folder.path() / "drive");
  const dataset::CanBus can_bus = dataset::readCanBus(folder.path() / "drive", tables.scenes[0].name);
  ASSERT_FALSE(tables.sample_data.empty());
  for (const auto& reading : tables.sample_data) {
    EXPECT_GE(reading.timestamp_us, can_bus.poses.front().timestamp_us);
    EXPECT_LE(reading.timestamp_us, can_bus.poses.back().timestamp_us);
  }
}

TEST(DriveSimulatorBytes, WhatThrowsInTheMiddleLeavesNothing) {
  const test::TemporaryFolder folder;
  DriveOptions options = smallDrive();
  options.duration_s = 0.5;
  options.width = 160;
  options.height = 90;
  {
    dataset::DatarootWriter writer(folder.path() / "drive", "v1.0-sim", false);
    const Scenario scenario = makeScenario("night", 0.5, 1);
    EXPECT_THROW(simulateDrive(scenario, options, 0, writer.workFolder(),
                               [](std::size_t done, std::size_t) {
                                 if (done == 5) throw std::runtime_error("enough");
                               }),
                 std::runtime_error);
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(DriveOptionsCheck, NamesTheOptionThatMakesNoSense) {
  const auto expectRefused = [](const DriveOptions& options, const std::string& part) {
    test::expectRefusal([&options] { checkOptions(options); }, {part});
  };
  DriveOptions options;
  checkOptions(options);
  options.duration_s = 0.0;
  expectRefused(options, "duration");
  options = {};
  options.duration_s = std::nan("");
  expectRefused(options, "duration");
  options = {};
  options.width = 0;
  expectRefused(options, "width is 0");
  options = {};
  options.radar_rate = 1.0;
  expectRefused(options, "radar_rate is 1 Hz");
  options = {};
  options.cameras = {"CAM_TOP"};
  expectRefused(options, "CAM_TOP");
}

}  // namespace
}  // namespace radar_dot::simulation
