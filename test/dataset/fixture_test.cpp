// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace radar_dot::dataset
