// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/can_bus.h"

#include <gtest/gtest.h>

#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

using test::NuscenesFixture;

class CanBusTest : public ::testing::Test {
 protected:
  static test::FixtureOptions options() {
    test::FixtureOptions options = test::FixtureOptions::tablesOnly();
    options.can_bus = true;
    return options;
  }
  std::filesystem::path file(std::string_view part) const {
    return fixture_.dataroot() / "can_bus" / ("scene-0002_" + std::string(part) + ".json");
  }
  NuscenesFixture fixture_{options()};
};

TEST_F(CanBusTest, HoldsTheDrive) {
  for (const test::FixtureScene& scene : fixture_.scenes()) {
    const CanBus can_bus = readCanBus(fixture_.dataroot(), scene.name);
    ASSERT_EQ(can_bus.poses.size(), 36U) << "0.7 s at 50 Hz, both ends";
    ASSERT_EQ(can_bus.imu.size(), 71U);
    ASSERT_EQ(can_bus.vehicle.size(), 71U);
    for (const CanPose& pose : can_bus.poses) {
      const Eigen::Isometry3d truth = scene.drive.T_map_from_base(pose.timestamp_us);
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(pose.position[static_cast<std::size_t>(i)], truth.translation()[i], 1e-9);
      const Eigen::Quaterniond rotation(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                                        pose.orientation[3]);
      EXPECT_TRUE(rotation.toRotationMatrix().isApprox(truth.linear(), 1e-12));
      EXPECT_EQ(pose.velocity, (std::array<double, 3>{scene.drive.speed, 0.0, 0.0}));
      EXPECT_EQ(pose.rotation_rate, (std::array<double, 3>{0.0, 0.0, scene.drive.yaw_rate}));
      EXPECT_EQ(pose.acceleration[2], 9.81);
    }
    for (const CanImu& imu : can_bus.imu) {
      EXPECT_EQ(imu.rotation_rate[2], scene.drive.yaw_rate);
      EXPECT_EQ(imu.linear_acceleration[1], scene.drive.speed * scene.drive.yaw_rate);
    }
    for (const CanVehicleInfo& info : can_bus.vehicle) {
      EXPECT_NEAR(rearAxleSpeed(info), scene.drive.speed, 1e-12);
      EXPECT_NEAR(info.odometer_speed_kph, 3.6 * scene.drive.speed, 1e-12);
      EXPECT_EQ(info.steering_angle_deg > 0.0, scene.drive.yaw_rate > 0.0);
      EXPECT_EQ(info.front_right_rpm > info.front_left_rpm, scene.drive.yaw_rate > 0.0) << "outer wheel";
      EXPECT_EQ(info.rear_right_rpm > info.rear_left_rpm, scene.drive.yaw_rate > 0.0) << "outer wheel";
    }
  }
}

TEST(RearAxleSpeed, SixtyTurnsAMinuteAreOneCircumferenceASecond) {
  CanVehicleInfo info;
  info.rear_left_rpm = 50.0;
  info.rear_right_rpm = 70.0;
  info.front_left_rpm = 1e6;  // the front wheels do not count
  EXPECT_NEAR(rearAxleSpeed(info), 2.0 * 3.141592653589793 * 0.305, 1e-12);
}

TEST_F(CanBusTest, AMissingPartIsEmpty) {
  std::filesystem::remove(file("ms_imu"));
  const CanBus can_bus = readCanBus(fixture_.dataroot(), "scene-0002");
  EXPECT_TRUE(can_bus.imu.empty());
  EXPECT_FALSE(can_bus.poses.empty());
  EXPECT_FALSE(can_bus.empty());
  EXPECT_TRUE(readCanBus(fixture_.dataroot(), "scene-0161").empty());
}

TEST_F(CanBusTest, RecordsAreSortedByTime) {
  test::writeFile(file("ms_imu"), R"([
    {"utime": 30, "linear_accel": [3, 0, 0], "q": [1, 0, 0, 0], "rotation_rate": [0, 0, 0]},
    {"utime": 10, "linear_accel": [1, 0, 0], "q": [1, 0, 0, 0], "rotation_rate": [0, 0, 0]},
    {"utime": 20, "linear_accel": [2, 0, 0], "q": [1, 0, 0, 0], "rotation_rate": [0, 0, 0]}])");
  const CanBus can_bus = readCanBus(fixture_.dataroot(), "scene-0002");
  ASSERT_EQ(can_bus.imu.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(can_bus.imu[i].timestamp_us, static_cast<std::int64_t>(10 * (i + 1)));
    EXPECT_EQ(can_bus.imu[i].linear_acceleration[0], static_cast<double>(i + 1));
  }
}

// Python writes NaN and Infinity as such. Of six rows those with the times 10 and 60 are sound.
TEST_F(CanBusTest, RowsWithoutAValueAreLeftOutAndCounted) {
  const auto row = [](int time, const char* wheel) {
    return "{\"utime\": " + std::to_string(time) + ", \"FL_wheel_speed\": 1, \"FR_wheel_speed\": 2, " +
           "\"RL_wheel_speed\": " + wheel +
           ", \"RR_wheel_speed\": 4, \"odom_speed\": 5, \"steer_corrected\": 6}";
  };
  test::writeFile(file("zoe_veh_info"), "[" + row(60, "7") + ", " + row(20, "NaN") + ", " +
                                            row(30, "-Infinity") + ", " + row(40, "null") + ", " +
                                            row(10, "3") + ", " + row(10, "9") + "]");
  const LeftOut left_out;
  const CanBus can_bus = readCanBus(fixture_.dataroot(), "scene-0002", left_out);
  ASSERT_EQ(can_bus.vehicle.size(), 2U);
  EXPECT_EQ(can_bus.vehicle[0].timestamp_us, 10);
  EXPECT_EQ(can_bus.vehicle[0].rear_left_rpm, 3.0);
  EXPECT_EQ(can_bus.vehicle[1].timestamp_us, 60);
  const auto entries = left_out.entries();
  ASSERT_EQ(entries.size(), 1U) << "the other parts are sound";
  const auto& [what, why] = *entries.begin();
  EXPECT_EQ(what, "can_bus/scene-0002_zoe_veh_info.json");
  EXPECT_EQ(why.rfind("4 of 6 rows, the first because: ", 0), 0U) << why;
  EXPECT_NE(why.find("record 1: field 'RL_wheel_speed' must be finite but is nan"), std::string::npos) << why;
}

TEST_F(CanBusTest, ErrorsNameFileRecordAndField) {
  const auto read = [&] { readCanBus(fixture_.dataroot(), "scene-0002"); };
  test::replaceInFile(file("zoe_veh_info"), "RL_wheel_speed", "rear_left");
  test::expectRefusal<DatasetError>(
      read, {"can_bus/scene-0002_zoe_veh_info.json record 0", "field 'RL_wheel_speed' is missing"});
  test::replaceInFile(file("pose"), "\"vel\": [", "\"vel\": [\"fast\", ");
  test::expectRefusal<DatasetError>(
      read, {"can_bus/scene-0002_pose.json record 0", "field 'vel' must hold 3 numbers"});
  test::writeFile(file("pose"), "[{\"utime\": 1");
  test::expectRefusal<DatasetError>(read, {"can_bus/scene-0002_pose.json: malformed JSON at byte 12"});
}

}  // namespace
}  // namespace radar_dot::dataset
