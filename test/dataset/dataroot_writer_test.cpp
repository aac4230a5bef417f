// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What DatarootWriter writes, read back by the package's own readers.
#include "radar_dot/dataset/dataroot_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "dataset/small_scene.h"
#include "fixtures/files.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

constexpr const char* kVersion = "v1.0-sim";

/// The reader rounds a decimal number to within a few units in the last place.
void expectSame(double read, double written) {
  EXPECT_NEAR(read, written, 1e-14 * std::max(1.0, std::abs(written)));
}
template <std::size_t N>
void expectSame(const std::array<double, N>& read, const std::array<double, N>& written) {
  for (std::size_t i = 0; i < N; ++i) expectSame(read[i], written[i]);
}

class DatarootWriterTest : public ::testing::Test {
 protected:
  DatarootWriterTest() {
    DatarootWriter writer(dataroot(), kVersion, false);
    for (const NewScene& scene : scenes_) {
      test::writeReadingFiles(scene, writer.workFolder());
      writer.add(scene);
    }
    writer.finish();
    tables_ = Tables::load(dataroot(), {kVersion, {}});
  }
  std::filesystem::path dataroot() const { return folder_.path() / "dataroot"; }
  Index row(const NewScene& scene) const { return tables_.findScene(scene.name); }

  void expectPose(const Eigen::Isometry3d& read, const NewSensor& written) const {
    const auto& q = written.rotation;
    EXPECT_TRUE(read.translation().isApprox(Eigen::Vector3d(written.translation.data()), 1e-14));
    EXPECT_TRUE(read.linear().isApprox(
        Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(), 1e-14));
  }

  void expectSensor(const CalibratedSensor& calibration, const NewSensor& written) const {
    const Sensor& sensor = at(tables_.sensors, calibration.sensor);
    EXPECT_EQ(sensor.channel, written.channel);
    EXPECT_EQ(sensor.modality, written.modality == "camera"  ? Modality::kCamera
                               : written.modality == "lidar" ? Modality::kLidar
                                                             : Modality::kRadar);
    expectPose(calibration.T_base_from_sensor, written);
    ASSERT_EQ(calibration.camera_matrix.has_value(), written.modality == "camera");
    for (std::size_t i = 0; i < written.camera_matrix.size(); ++i)
      expectSame((*calibration.camera_matrix)(static_cast<int>(i / 3), static_cast<int>(i % 3)),
                 written.camera_matrix[i]);
  }

  void expectReading(const NewScene& scene, const SampleData& read, const NewReading& written) const {
    EXPECT_EQ(read.timestamp_us, written.timestamp_us);
    EXPECT_EQ(read.sample, tables_.samplesOf(row(scene)).at(written.sample));
    EXPECT_EQ(read.is_key_frame, written.is_key_frame);
    EXPECT_EQ(tables_.filename(read), written.filename);
    EXPECT_EQ(read.width, written.width);
    EXPECT_EQ(read.height, written.height);
    const EgoPose& pose = at(tables_.ego_poses, read.ego_pose);
    EXPECT_EQ(pose.token, read.token);
    EXPECT_EQ(pose.timestamp_us, written.timestamp_us);
    expectSame(pose.translation, written.ego_pose.translation);
    expectSame(pose.rotation, written.ego_pose.rotation);
    expectSensor(at(tables_.calibrated_sensors, read.calibrated_sensor), scene.sensors[written.sensor]);
  }

  std::vector<std::string> names(const std::vector<Index>& attributes) const {
    std::vector<std::string> found;
    for (const Index i : attributes) found.push_back(at(tables_.attributes, i).name);
    return found;
  }

  test::TemporaryFolder folder_;
  const std::vector<NewScene> scenes_ = {test::smallScene(1), test::smallScene(2)};
  Tables tables_;
};

TEST_F(DatarootWriterTest, ScenesAndSamplesComeBack) {
  ASSERT_EQ(tables_.scenes.size(), 2U);
  EXPECT_EQ(tables_.samples.size(), 6U);
  for (const NewScene& scene : scenes_) {
    EXPECT_EQ(at(tables_.logs, at(tables_.scenes, row(scene)).log).vehicle, scene.vehicle);
    const std::vector<Index> samples = tables_.samplesOf(row(scene));
    ASSERT_EQ(samples.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(at(tables_.samples, samples[i]).timestamp_us, scene.samples_us[i]);
  }
}

TEST_F(DatarootWriterTest, ReadingsComeBackWithPosesCalibrationsAndChains) {
  std::size_t count = 0;
  for (const NewScene& scene : scenes_) {
    EXPECT_EQ(tables_.channelsOf(row(scene)),
              (std::vector<std::string>{"CAM_FRONT", "LIDAR_TOP", "RADAR_FRONT"}));
    for (std::size_t sensor = 0; sensor < scene.sensors.size(); ++sensor) {
      const std::vector<Index> rows = tables_.readingsOf(row(scene), scene.sensors[sensor].channel);
      std::vector<NewReading> written;
      for (const NewReading& reading : scene.readings)
        if (reading.sensor == sensor) written.push_back(reading);
      ASSERT_EQ(rows.size(), written.size());
      count += rows.size();
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const SampleData& read = at(tables_.sample_data, rows[i]);
        expectReading(scene, read, written[i]);
        EXPECT_EQ(read.previous, i == 0 ? kNone : rows[i - 1]);
      }
    }
  }
  EXPECT_EQ(tables_.sample_data.size(), count);
  EXPECT_EQ(tables_.ego_poses.size(), count);
}

TEST_F(DatarootWriterTest, AnnotationsComeBackWithTheirInstances) {
  ASSERT_EQ(tables_.annotations.size(), 8U);
  EXPECT_EQ(tables_.instances.size(), 4U) << "the truck is never annotated";
  for (const NewScene& scene : scenes_) {
    const std::vector<Index> samples = tables_.samplesOf(row(scene));
    for (const NewAnnotation& written : scene.annotations) {
      const std::vector<Index> rows = tables_.annotationsOf(samples.at(written.sample));
      EXPECT_EQ(rows.size(), written.sample == 1 ? 2U : 1U);
      const auto found = std::find_if(rows.begin(), rows.end(), [&](Index i) {
        const Instance& instance = at(tables_.instances, at(tables_.annotations, i).instance);
        return at(tables_.categories, instance.category).name == scene.instances[written.instance];
      });
      ASSERT_NE(found, rows.end());
      const SampleAnnotation& read = at(tables_.annotations, *found);
      expectSame(read.translation, written.translation);
      expectSame(read.size, written.size);
      expectSame(read.rotation, written.rotation);
      EXPECT_EQ(names(read.attributes), written.attributes);
    }
  }
}

TEST_F(DatarootWriterTest, AnnotationsOfAnInstanceFollowEachOtherInTime) {
  std::map<std::string, int> counts;
  for (const SampleAnnotation& annotation : tables_.annotations) {
    ++counts[at(tables_.categories, at(tables_.instances, annotation.instance).category).name];
    if (annotation.next == kNone) continue;
    const SampleAnnotation& next = at(tables_.annotations, annotation.next);
    EXPECT_EQ(next.instance, annotation.instance);
    EXPECT_GT(at(tables_.samples, next.sample).timestamp_us,
              at(tables_.samples, annotation.sample).timestamp_us);
  }
  for (const auto& [category, count] : counts) EXPECT_EQ(count, category == "vehicle.car" ? 6 : 2);
}

TEST_F(DatarootWriterTest, AllNamesOfNuscenesAreThere) {
  EXPECT_EQ(tables_.categories.size(), 23U);
  EXPECT_EQ(tables_.attributes.size(), 8U);
  EXPECT_EQ(tables_.sensors.size(), 3U) << "shared by the scenes";
  EXPECT_EQ(tables_.calibrated_sensors.size(), 6U) << "of each scene";
}

TEST_F(DatarootWriterTest, MasksComeBack) {
  const std::vector<InstanceMask> masks = readInstanceMasks(tables_);
  ASSERT_EQ(masks.size(), 6U) << "the empty masks are left out";
  std::size_t next = 0;
  for (const NewScene& scene : scenes_) {
    for (const NewMask& written : scene.masks) {
      if (written.instance == 1) continue;
      const InstanceMask& read = masks[next++];
      const SampleData& reading = at(tables_.sample_data, tables_.findReading(read.sample_data_token));
      EXPECT_EQ(reading.timestamp_us, scene.readings[written.reading].timestamp_us);
      EXPECT_EQ(read.filename, tables_.filename(reading));
      EXPECT_EQ(read.category_name, scene.instances[written.instance]);
      EXPECT_TRUE(isMoving(tables_, read));
      EXPECT_EQ(read.attribute_tokens.size(), 1U);
      EXPECT_EQ(cv::countNonZero(decodeMask(read) != decodeMask(written.mask)), 0);
      const double first_row = 2.0 + static_cast<double>(scene.readings[written.reading].sample);
      const double first_column = &scene == &scenes_[0] ? 1.0 : 2.0;
      EXPECT_EQ(read.bounding_box, (std::array<double, 4>{first_column, first_row, 7.0, 11.0}));
    }
  }
}

TEST_F(DatarootWriterTest, CanMessagesComeBack) {
  for (const NewScene& scene : scenes_) {
    const CanBus read = readCanBus(dataroot(), scene.name);
    ASSERT_EQ(read.poses.size(), 3U);
    ASSERT_EQ(read.imu.size(), 3U);
    ASSERT_EQ(read.vehicle.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const CanPose& pose = scene.can_bus.poses[i];
      EXPECT_EQ(read.poses[i].timestamp_us, pose.timestamp_us);
      expectSame(read.poses[i].position, pose.position);
      expectSame(read.poses[i].orientation, pose.orientation);
      expectSame(read.poses[i].velocity, pose.velocity);
      expectSame(read.poses[i].acceleration, pose.acceleration);
      expectSame(read.poses[i].rotation_rate, pose.rotation_rate);
      const CanImu& imu = scene.can_bus.imu[i];
      EXPECT_EQ(read.imu[i].timestamp_us, imu.timestamp_us);
      expectSame(read.imu[i].linear_acceleration, imu.linear_acceleration);
      expectSame(read.imu[i].orientation, imu.orientation);
      expectSame(read.imu[i].rotation_rate, imu.rotation_rate);
      const CanVehicleInfo& vehicle = scene.can_bus.vehicle[i];
      EXPECT_EQ(read.vehicle[i].timestamp_us, vehicle.timestamp_us);
      expectSame(read.vehicle[i].front_left_rpm, vehicle.front_left_rpm);
      expectSame(read.vehicle[i].front_right_rpm, vehicle.front_right_rpm);
      expectSame(read.vehicle[i].rear_left_rpm, vehicle.rear_left_rpm);
      expectSame(read.vehicle[i].rear_right_rpm, vehicle.rear_right_rpm);
      expectSame(read.vehicle[i].odometer_speed_kph, vehicle.odometer_speed_kph);
      expectSame(read.vehicle[i].steering_angle_deg, vehicle.steering_angle_deg);
    }
  }
}

TEST_F(DatarootWriterTest, FilesPutIntoTheWorkFolderAreInTheDataroot) {
  for (const SampleData& reading : tables_.sample_data) {
    const std::string& channel = tables_.channelOf(reading);
    ASSERT_TRUE(std::filesystem::exists(tables_.path(reading))) << tables_.filename(reading);
    if (channel == "CAM_FRONT") continue;
    const PointCloud cloud =
        channel == "LIDAR_TOP" ? readLidarBin(tables_.path(reading)) : readPcd(tables_.path(reading));
    EXPECT_LT(cloud.size, 4U);
  }
}

TEST(DatarootWriterCanBus, PartsWithoutMessagesGetNoFile) {
  const test::TemporaryFolder folder;
  NewScene scene = test::smallScene(1);
  scene.can_bus = {};
  DatarootWriter writer(folder.path() / "dataroot", kVersion, false);
  writer.add(scene);
  writer.finish();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "dataroot/can_bus"));
}

TEST(DatarootWriterEmpty, ADatarootWithoutScenesIsValid) {
  const test::TemporaryFolder folder;
  DatarootWriter(folder.path() / "dataroot", kVersion, false).finish();
  EXPECT_TRUE(Tables::load(folder.path() / "dataroot", {kVersion, {}}).scenes.empty());
}

}  // namespace
}  // namespace radar_dot::dataset
