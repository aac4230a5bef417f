// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "fixtures/nuscenes_fixture.h"

namespace radar_dot::dataset {
namespace {

using test::FixtureScene;
using test::NuscenesFixture;

class TablesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    test::FixtureOptions options;
    options.channels_on_disk = {"RADAR_FRONT"};
    fixture_ = std::make_unique<NuscenesFixture>(options);
    tables_ = std::make_unique<Tables>(Tables::load(fixture_->dataroot()));
  }
  static inline std::unique_ptr<NuscenesFixture> fixture_;
  static inline std::unique_ptr<Tables> tables_;
};

/// Every reference must lead to a row.
void expectEveryReferenceToHold(const Tables& tables) {
  for (const CalibratedSensor& row : tables.calibrated_sensors)
    EXPECT_NO_THROW(at(tables.sensors, row.sensor));
  for (const Scene& row : tables.scenes) EXPECT_NO_THROW(at(tables.logs, row.log));
  const auto size = [](const auto& rows) { return static_cast<Index>(rows.size()); };
  for (const Sample& row : tables.samples) EXPECT_NO_THROW(at(tables.scenes, row.scene));
  for (Index i = 0; i < size(tables.sample_data); ++i) {
    const SampleData& row = at(tables.sample_data, i);
    EXPECT_NO_THROW(at(tables.samples, row.sample));
    EXPECT_NO_THROW(at(tables.calibrated_sensors, row.calibrated_sensor));
    EXPECT_EQ(at(tables.ego_poses, row.ego_pose).timestamp_us, row.timestamp_us);
    EXPECT_EQ(tables.findReading(row.token), i);
    if (row.previous != kNone) {
      const SampleData& previous = at(tables.sample_data, row.previous);
      EXPECT_EQ(tables.channelOf(previous), tables.channelOf(row));
      EXPECT_LT(previous.timestamp_us, row.timestamp_us);
    }
  }
  for (Index i = 0; i < size(tables.annotations); ++i) {
    const SampleAnnotation& row = at(tables.annotations, i);
    EXPECT_NO_THROW(at(tables.samples, row.sample));
    EXPECT_NO_THROW(at(tables.instances, row.instance));
    for (const Index attribute : row.attributes) EXPECT_NO_THROW(at(tables.attributes, attribute));
    if (row.next != kNone) {
      EXPECT_EQ(at(tables.annotations, row.next).previous, i);
      EXPECT_EQ(at(tables.annotations, row.next).instance, row.instance);
    }
  }
  for (const Instance& row : tables.instances) EXPECT_NO_THROW(at(tables.categories, row.category));
}

TEST_F(TablesTest, EveryReferenceHolds) {
  expectEveryReferenceToHold(*tables_);
  EXPECT_EQ(tables_->scenes.size(), 2U);
  EXPECT_EQ(tables_->samples.size(), 8U);
  EXPECT_EQ(tables_->instances.size(), 4U);
  EXPECT_EQ(tables_->annotations.size(), 16U);
  EXPECT_EQ(tables_->sensors.size(), 7U);
  EXPECT_EQ(tables_->calibrated_sensors.size(), 14U);
}

TEST_F(TablesTest, FieldsArriveAsWritten) {
  EXPECT_EQ(tables_->dataroot(), fixture_->dataroot());
  EXPECT_EQ(tables_->version(), "v1.0-mini");
  EXPECT_EQ(tables_->categories[1].name, "vehicle.car");

  const SampleAnnotation& moving = tables_->annotations[0];
  EXPECT_EQ(at(tables_->attributes, moving.attributes.at(0)).name, "vehicle.moving");
  EXPECT_EQ(moving.size, (std::array<double, 3>{1.9, 4.6, 1.7}));
}

TEST_F(TablesTest, CalibrationsHoldMountAndCameraMatrix) {
  for (const CalibratedSensor& row : tables_->calibrated_sensors) {
    const Sensor& sensor = at(tables_->sensors, row.sensor);
    EXPECT_EQ(row.camera_matrix.has_value(), sensor.modality == Modality::kCamera) << sensor.channel;
    if (row.camera_matrix) {
      const Eigen::Matrix3d expected = (Eigen::Matrix3d() << 1260, 0, 800, 0, 1260, 450, 0, 0, 1).finished();
      EXPECT_EQ(*row.camera_matrix, expected);
    }
    for (const test::Mount& mount : test::radarMounts()) {
      if (mount.channel != sensor.channel) continue;
      EXPECT_TRUE(row.T_base_from_sensor.translation().isApprox(mount.translation));
      EXPECT_TRUE(row.T_base_from_sensor.linear().isApprox(mount.rotation.toRotationMatrix(), 1e-12));
    }
  }
}

TEST_F(TablesTest, ReadingsAreInTimeOrderWithOneKeyframePerSample) {
  for (const FixtureScene& truth : fixture_->scenes()) {
    const Index scene = tables_->findScene(truth.name);
    ASSERT_NE(scene, kNone);
    const std::vector<Index> samples = tables_->samplesOf(scene);
    ASSERT_EQ(samples.size(), 4U);
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(at(tables_->samples, samples[static_cast<std::size_t>(k)]).timestamp_us,
                fixture_->sampleTime(truth, k));
    for (const test::Mount& mount : test::radarMounts()) {
      const std::vector<Index> readings = tables_->readingsOf(scene, mount.channel);
      EXPECT_GE(readings.size(), 19U) << "1.5 s at 13 Hz";
      std::vector<Index> key_samples;
      std::int64_t previous = 0;
      for (const Index i : readings) {
        const SampleData& reading = at(tables_->sample_data, i);
        EXPECT_GT(reading.timestamp_us, previous);
        previous = reading.timestamp_us;
        EXPECT_EQ(tables_->channelOf(reading), mount.channel);
        if (reading.is_key_frame) key_samples.push_back(reading.sample);
      }
      EXPECT_EQ(key_samples, samples) << mount.channel;
    }
  }
  EXPECT_EQ(tables_->findScene("scene-9999"), kNone);
  EXPECT_TRUE(tables_->readingsOf(0, "CAM_BACK").empty());
}

TEST_F(TablesTest, ChannelsAnnotationsAndPosesOfAScene) {
  const Index straight = tables_->findScene(NuscenesFixture::kStraightScene);
  const Index turning = tables_->findScene(NuscenesFixture::kTurningScene);
  const std::vector<std::string> channels = {"CAM_FRONT",        "LIDAR_TOP",   "RADAR_BACK_LEFT",
                                             "RADAR_BACK_RIGHT", "RADAR_FRONT", "RADAR_FRONT_LEFT",
                                             "RADAR_FRONT_RIGHT"};
  EXPECT_EQ(tables_->channelsOf(straight), channels);
  EXPECT_EQ(tables_->channelsOf(turning).size(), 6U) << "no lidar there";

  for (const Index sample : tables_->samplesOf(turning)) {
    const std::vector<Index> annotations = tables_->annotationsOf(sample);
    EXPECT_EQ(annotations.size(), 2U);
    for (const Index i : annotations) EXPECT_EQ(at(tables_->annotations, i).sample, sample);
  }
  const FixtureScene& truth = fixture_->scene(NuscenesFixture::kTurningScene);
  std::int64_t previous = 0;
  const std::vector<Index> poses = tables_->egoPosesOf(turning);
  EXPECT_GT(poses.size(), 90U);
  for (const Index i : poses) {
    const EgoPose& pose = at(tables_->ego_poses, i);
    EXPECT_GT(pose.timestamp_us, previous);
    previous = pose.timestamp_us;
    EXPECT_TRUE(pose.T_map_from_base().isApprox(truth.drive.T_map_from_base(pose.timestamp_us), 1e-12));
  }
}

TEST_F(TablesTest, EgoPosesOfOneStampAreListedOnce) {
  const Index straight = tables_->findScene(NuscenesFixture::kStraightScene);
  std::set<std::int64_t> stamps;
  std::size_t readings = 0;
  for (const std::string& channel : tables_->channelsOf(straight))
    for (const Index i : tables_->readingsOf(straight, channel)) {
      stamps.insert(at(tables_->sample_data, i).timestamp_us);
      ++readings;
    }
  EXPECT_EQ(tables_->egoPosesOf(straight).size(), stamps.size());
  EXPECT_LE(stamps.size(), readings);
}

TEST_F(TablesTest, PathsLeadToTheFiles) {
  for (const Index i : tables_->readingsOf(0, "RADAR_FRONT")) {
    const SampleData& reading = at(tables_->sample_data, i);
    EXPECT_TRUE(std::filesystem::exists(tables_->path(reading))) << tables_->filename(reading);
    EXPECT_EQ(tables_->filename(reading).substr(0, 7), reading.is_key_frame ? "samples" : "sweeps/");
  }
  const SampleData& absent = at(tables_->sample_data, tables_->readingsOf(0, "CAM_FRONT").at(0));
  EXPECT_FALSE(std::filesystem::exists(tables_->path(absent)));
  EXPECT_EQ(absent.width, 1600);
  EXPECT_EQ(absent.height, 900);
}

TEST_F(TablesTest, ASceneFilterKeepsExactlyThatScene) {
  LoadOptions options;
  options.scenes = {NuscenesFixture::kTurningScene};
  const Tables part = Tables::load(fixture_->dataroot(), options);
  expectEveryReferenceToHold(part);
  ASSERT_EQ(part.scenes.size(), 1U);
  EXPECT_EQ(part.scenes[0].name, NuscenesFixture::kTurningScene);
  EXPECT_EQ(part.samples.size(), 4U);
  EXPECT_EQ(part.instances.size(), 2U);
  EXPECT_EQ(part.annotations.size(), 8U);

  const Index scene = tables_->findScene(NuscenesFixture::kTurningScene);
  std::size_t readings = 0;
  for (const std::string& channel : tables_->channelsOf(scene))
    readings += tables_->readingsOf(scene, channel).size();
  EXPECT_EQ(part.sample_data.size(), readings);
  EXPECT_EQ(part.ego_poses.size(), readings);
  const std::vector<Index> whole = tables_->readingsOf(scene, "RADAR_FRONT");
  const std::vector<Index> partial = part.readingsOf(0, "RADAR_FRONT");
  ASSERT_EQ(partial.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i)
    EXPECT_EQ(part.filename(at(part.sample_data, partial[i])),
              tables_->filename(at(tables_->sample_data, whole[i])));
}

TEST_F(TablesTest, WithoutAnnotationsTheirTablesNeedNotExist) {
  const NuscenesFixture fixture;
  std::filesystem::remove(fixture.table("sample_annotation"));
  std::filesystem::remove(fixture.table("instance"));
  LoadOptions options;
  options.annotations = false;
  const Tables tables = Tables::load(fixture.dataroot(), options);
  EXPECT_TRUE(tables.annotations.empty());
  EXPECT_TRUE(tables.annotationsOf(0).empty());
  EXPECT_EQ(tables.samples.size(), 8U);
}

TEST(Tables, FieldsInAnyOrderAndUnknownFieldsAreRead) {
  const NuscenesFixture fixture;
  test::writeFile(fixture.table("category"),
                  R"([{"extra": {"deep": [1, [2, {"token": "no"}], null]}, "name": "\u00e9", "token": "1"},
                      {"token": "2", "name": "b", "more": [[], {}]}, {"name": "c", "token": "3"}])");
  LoadOptions options;
  options.annotations = false;
  const Tables tables = Tables::load(fixture.dataroot(), options);
  ASSERT_EQ(tables.categories.size(), 3U);
  EXPECT_EQ(tables.categories[0].name, "\xc3\xa9");
  EXPECT_EQ(tables.categories[2].name, "c");
  EXPECT_EQ(tables.tokens.text(tables.categories[0].token), "1");
}

}  // namespace
}  // namespace radar_dot::dataset
