// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "fixtures/nuscenes_fixture.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

using test::FixtureScene;
using test::NuscenesFixture;

double value(const PointCloud& cloud, std::size_t record, const char* name) {
  const PointField* field = findField(cloud.fields, name);
  return readScalar(cloud.view().point(record) + field->offset, field->type);
}

double rangeRate(const PointCloud& cloud, std::size_t record, const char* vx, const char* vy) {
  const double x = value(cloud, record, "x");
  const double y = value(cloud, record, "y");
  return (x * value(cloud, record, vx) + y * value(cloud, record, vy)) / std::hypot(x, y);
}

/// The promise of simulateScan, checked with nothing but the files and numerical differentiation of
/// the drive's poses.
TEST(Fixture, StaticReturnsHoldTheExactDopplerOfTheDrive) {
  const NuscenesFixture fixture;
  const Tables tables = Tables::load(fixture.dataroot());
  for (const FixtureScene& scene : fixture.scenes()) {
    for (const test::Mount& mount : test::radarMounts()) {
      for (const Index i : tables.readingsOf(tables.findScene(scene.name), mount.channel)) {
        const SampleData& reading = tables.sample_data[static_cast<std::size_t>(i)];
        const Eigen::Isometry3d T_base_from_sensor =
            tables.calibrated_sensors[static_cast<std::size_t>(reading.calibrated_sensor)].T_base_from_sensor;
        const auto sensorPose = [&](std::int64_t time_us) {
          return Eigen::Isometry3d(scene.drive.T_map_from_base(time_us) * T_base_from_sensor);
        };
        const std::int64_t now = reading.timestamp_us;
        const PointCloud cloud = readPcd(tables.path(reading));
        ASSERT_EQ(cloud.size, 40U);
        for (std::size_t k = 0; k < cloud.size; ++k) {
          const Eigen::Vector3d point(value(cloud, k, "x"), value(cloud, k, "y"), 0.0);
          // The distance from the moving sensor to the point, which stays where it is in the map.
          const Eigen::Vector3d in_map = sensorPose(now) * point;
          const auto distance = [&](std::int64_t time_us) {
            return (sensorPose(time_us).inverse() * in_map).head<2>().norm();
          };
          const double static_rate = (distance(now + 1000) - distance(now - 1000)) / 2e-3;
          const bool moves = k >= 32;
          EXPECT_EQ(value(cloud, k, "dyn_prop"), moves ? 0.0 : 1.0);
          const double over_ground = rangeRate(cloud, k, "vx_comp", "vy_comp");
          EXPECT_NEAR(rangeRate(cloud, k, "vx", "vy") - over_ground, static_rate, 1e-4);
          if (!moves) {
            EXPECT_EQ(over_ground, 0.0);
          } else {
            EXPECT_GT(std::abs(over_ground), 2.9);
          }
        }
      }
    }
  }
}

TEST(Fixture, FrontRadarSeesTheMovingBox) {
  const NuscenesFixture fixture;
  const Tables tables = Tables::load(fixture.dataroot());
  const FixtureScene& scene = fixture.scene(NuscenesFixture::kStraightScene);
  const std::vector<Index> readings = tables.readingsOf(tables.findScene(scene.name), "RADAR_FRONT");
  ASSERT_GT(readings.size(), 10U);
  for (const Index i : readings) {
    const SampleData& reading = tables.sample_data[static_cast<std::size_t>(i)];
    const Eigen::Isometry3d T_box_from_sensor =
        scene.moving_box.T_map_from_box(scene.drive, reading.timestamp_us).inverse() *
        scene.drive.T_map_from_base(reading.timestamp_us) *
        tables.calibrated_sensors[static_cast<std::size_t>(reading.calibrated_sensor)].T_base_from_sensor;
    const PointCloud cloud = readPcd(tables.path(reading));
    ASSERT_EQ(cloud.size, 40U);
    for (std::size_t k = 0; k < cloud.size; ++k) {
      const Eigen::Vector3d in_box =
          T_box_from_sensor * Eigen::Vector3d(value(cloud, k, "x"), value(cloud, k, "y"), 0.0);
      const bool inside = std::abs(in_box.x()) < 2.3 && std::abs(in_box.y()) < 0.95;
      EXPECT_EQ(inside, k >= 32) << "point " << k;
    }
  }
}

TEST(Fixture, OptionsChangeWhatTheySay) {
  test::FixtureOptions options;
  options.samples_per_scene = 2;
  options.scan.points = 10;
  options.scan.dynamic_fraction = 0.0;
  options.scan.velocity_quantum = 0.25;
  options.channels_on_disk = {"RADAR_FRONT"};
  options.can_bus = false;
  options.instance_masks = false;
  const NuscenesFixture fixture(options);
  const Tables tables = Tables::load(fixture.dataroot());
  EXPECT_EQ(tables.samples.size(), 4U);
  EXPECT_FALSE(std::filesystem::exists(fixture.dataroot() / "can_bus"));
  EXPECT_FALSE(std::filesystem::exists(fixture.table("nuinsseg")));
  EXPECT_FALSE(std::filesystem::exists(fixture.dataroot() / "samples" / "RADAR_BACK_LEFT"));
  const SampleData& reading =
      tables.sample_data[static_cast<std::size_t>(tables.readingsOf(0, "RADAR_FRONT").at(0))];
  const PointCloud cloud = readPcd(tables.path(reading));
  ASSERT_EQ(cloud.size, 10U);
  for (std::size_t k = 0; k < cloud.size; ++k) {
    EXPECT_EQ(value(cloud, k, "dyn_prop"), 1.0);
    EXPECT_EQ(std::remainder(value(cloud, k, "vx"), 0.25), 0.0);
  }
}

TEST(Fixture, TheSameSeedGivesTheSameFiles) {
  test::FixtureOptions options;
  options.samples_per_scene = 2;
  options.channels_on_disk = {"RADAR_FRONT"};
  const NuscenesFixture first(options), second(options);
  options.seed = 2;
  const NuscenesFixture other(options);
  const Tables tables = Tables::load(first.dataroot());
  const std::string name(tables.filename(tables.sample_data.at(0)));
  EXPECT_EQ(test::readFile(first.dataroot() / name), test::readFile(second.dataroot() / name));
  EXPECT_NE(test::readFile(first.dataroot() / name), test::readFile(other.dataroot() / name));
  EXPECT_EQ(test::readFile(first.table("sample_data")), test::readFile(other.table("sample_data")));
}

TEST(Fixture, CameraAndLidarFiles) {
  const NuscenesFixture fixture;
  const Tables tables = Tables::load(fixture.dataroot());
  for (const Index i : tables.readingsOf(1, "CAM_FRONT")) {
    const cv::Mat image = cv::imread(tables.path(tables.sample_data[static_cast<std::size_t>(i)]).string());
    EXPECT_EQ(image.size(), cv::Size(1600, 900));
    EXPECT_GT(image.at<cv::Vec3b>(450, 800)[0], 240);
    EXPECT_LT(image.at<cv::Vec3b>(100, 100)[0], 120);
  }
  const std::vector<Index> lidar = tables.readingsOf(0, "LIDAR_TOP");
  ASSERT_EQ(lidar.size(), 1U);
  EXPECT_EQ(readLidarBin(tables.path(tables.sample_data[static_cast<std::size_t>(lidar[0])])).size, 500U);
}

}  // namespace
}  // namespace radar_dot::dataset
