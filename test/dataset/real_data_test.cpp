// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    dataroot_ = std::filesystem::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real";
    if (!std::filesystem::exists(dataroot_)) GTEST_SKIP() << "no real data in " << dataroot_;
  }
  std::filesystem::path dataroot_;
};

TEST_F(RealData, EveryRadarFileIsRead) {
  const Tables tables = Tables::load(dataroot_);
  ASSERT_EQ(tables.scenes.size(), 6U);
  std::size_t files = 0;
  std::size_t points = 0;
  for (const SampleData& reading : tables.sample_data) {
    if (tables.channelOf(reading).substr(0, 5) != "RADAR") continue;
    const PointCloud cloud = readPcd(tables.path(reading));
    ASSERT_EQ(cloud.fields.size(), 18U);
    ASSERT_EQ(cloud.point_step, 43U);
    ASSERT_EQ(cloud.data.size(), 43 * cloud.size);
    ++files;
    points += cloud.size;
  }
  EXPECT_EQ(files, 7868U);
  EXPECT_EQ(points, 701766U);
}

TEST_F(RealData, EverySceneHasFiveRadarsAndACanBus) {
  const Tables tables = Tables::load(dataroot_);
  for (Index scene = 0; scene < static_cast<Index>(tables.scenes.size()); ++scene) {
    const Scene& row = tables.scenes[static_cast<std::size_t>(scene)];
    EXPECT_GT(tables.samplesOf(scene).size(), 30U) << row.name;
    for (const char* channel :
         {"RADAR_FRONT", "RADAR_FRONT_LEFT", "RADAR_FRONT_RIGHT", "RADAR_BACK_LEFT", "RADAR_BACK_RIGHT"})
      EXPECT_GT(tables.readingsOf(scene, channel).size(), 200U) << row.name << " " << channel;
    const CanBus can_bus = readCanBus(dataroot_, row.name);
    EXPECT_GT(can_bus.poses.size(), 900U);
    EXPECT_GT(can_bus.imu.size(), 1800U);
    EXPECT_GT(can_bus.vehicle.size(), 1800U);
  }
}

TEST_F(RealData, AFilteredSceneAgreesWithTheWhole) {
  const Tables whole = Tables::load(dataroot_);
  LoadOptions options;
  options.scenes = {"scene-0103"};
  const Tables part = Tables::load(dataroot_, options);
  ASSERT_EQ(part.scenes.size(), 1U);
  const Index scene = whole.findScene("scene-0103");
  EXPECT_EQ(part.channelsOf(0), whole.channelsOf(scene));
  std::size_t readings = 0;
  for (const std::string& channel : part.channelsOf(0)) {
    EXPECT_EQ(part.readingsOf(0, channel).size(), whole.readingsOf(scene, channel).size());
    readings += part.readingsOf(0, channel).size();
  }
  EXPECT_EQ(part.sample_data.size(), readings);
  std::size_t annotations = 0;
  for (const Index sample : whole.samplesOf(scene)) annotations += whole.annotationsOf(sample).size();
  EXPECT_EQ(part.annotations.size(), annotations);
}

TEST_F(RealData, MasksLieWithinTheirBoxes) {
  Tables tables = Tables::load(dataroot_);
  const std::vector<InstanceMask> masks = readInstanceMasks(tables);
  ASSERT_GT(masks.size(), 100U);
  std::size_t moving = 0;
  for (const InstanceMask& instance : masks) {
    const cv::Mat mask = decodeMask(instance);
    ASSERT_EQ(mask.size(), cv::Size(1600, 900));
    const auto& box = instance.bounding_box;
    const cv::Rect area(cv::Point(static_cast<int>(box[0]), static_cast<int>(box[1])),
                        cv::Point(static_cast<int>(box[2]) + 1, static_cast<int>(box[3]) + 1));
    const cv::Rect image(0, 0, mask.cols, mask.rows);
    EXPECT_EQ(cv::countNonZero(mask(area & image)), cv::countNonZero(mask))
        << tables.tokens.text(instance.token);
    moving += isMoving(tables, instance) ? 1 : 0;
  }
  EXPECT_GT(moving, 0U);
  EXPECT_LT(moving, masks.size());
}

TEST_F(RealData, TheLidarFileIsRead) {
  const Tables tables = Tables::load(dataroot_);
  const std::vector<Index> readings = tables.readingsOf(tables.findScene("scene-0061"), "LIDAR_TOP");
  ASSERT_FALSE(readings.empty());
  const PointCloud cloud =
      readLidarBin(tables.path(tables.sample_data[static_cast<std::size_t>(readings[0])]));
  EXPECT_GT(cloud.size, 30000U);
}

}  // namespace
}  // namespace radar_dot::dataset
