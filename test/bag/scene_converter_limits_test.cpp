// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What a conversion leaves out, and what it does when it cannot go on.
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bag/bag_reading.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"
#include "radar_dot/bag/scene_converter.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;
using dataset::Tables;
using test::BagReader;
using test::NuscenesFixture;

class SceneConverterLimits : public testing::Test {
 protected:
  ConvertSummary convert(const ConvertOptions& options = {}, const ProgressCallback& progress = {}) {
    return convertScene(tables_, 0, folder_.path(), options, progress);
  }
  fs::path bagPath() const { return folder_.path() / (tables_.scenes[0].name + ".bag"); }
  fs::path fileOf(const std::string& channel, std::size_t reading) const {
    return tables_.path(
        tables_.sample_data[static_cast<std::size_t>(tables_.readingsOf(0, channel)[reading])]);
  }
  std::size_t countOf(const std::string& channel) const { return tables_.readingsOf(0, channel).size(); }

  NuscenesFixture fixture_;
  Tables tables_ = Tables::load(fixture_.dataroot());
  test::TemporaryFolder folder_;
};

TEST_F(SceneConverterLimits, CountsFilesThatAreNotOnDiskAndConvertsTheOthers) {
  fs::remove(fileOf("RADAR_FRONT", 0));
  fs::remove(fileOf("RADAR_FRONT", 5));
  for (std::size_t i = 0; i < countOf("CAM_FRONT"); ++i) fs::remove(fileOf("CAM_FRONT", i));
  const ConvertSummary summary = convert();
  ASSERT_EQ(summary.missing.size(), 2U);
  EXPECT_EQ(summary.missing.at("RADAR_FRONT").missing, 2U);
  EXPECT_EQ(summary.missing.at("RADAR_FRONT").listed, countOf("RADAR_FRONT"));
  EXPECT_EQ(summary.missing.at("CAM_FRONT").missing, countOf("CAM_FRONT"));
  BagReader bag(summary.file);
  const auto counts = bag.counts();
  EXPECT_EQ(counts.at("/radar_front"), countOf("RADAR_FRONT") - 2);
  EXPECT_EQ(counts.count("/cam_front/image/compressed"), 0U);
  EXPECT_EQ(counts.count("/cam_front/camera_info"), 0U);
  EXPECT_EQ(bag.messages<tf2_msgs::TFMessage>("/tf_static").at(0)->transforms.size(),
            tables_.channelsOf(0).size());
}

TEST_F(SceneConverterLimits, MasksComeWithIntrinsicsEvenWithoutTheImage) {
  const std::vector<dataset::InstanceMask> masks = readInstanceMasks(tables_);
  fs::remove(fileOf("CAM_FRONT", 1));
  ConvertOptions options;
  options.masks = &masks;
  const auto counts = BagReader(convert(options).file).counts();
  EXPECT_EQ(counts.at("/cam_front/image/compressed"), countOf("CAM_FRONT") - 1);
  EXPECT_EQ(counts.at("/ground_truth/dynamic_mask/compressed"), countOf("CAM_FRONT"));
  EXPECT_EQ(counts.at("/cam_front/camera_info"), countOf("CAM_FRONT"));
}

// The images of the fixture under another name.
TEST_F(SceneConverterLimits, MasksOfOtherCamerasHaveTopicsOfTheirOwn) {
  test::replaceInFile(fixture_.table("sensor"), "CAM_FRONT", "CAM_BACK");
  tables_ = Tables::load(fixture_.dataroot());
  const std::vector<dataset::InstanceMask> masks = readInstanceMasks(tables_);
  ConvertOptions options;
  options.masks = &masks;
  const auto counts = BagReader(convert(options).file).counts();
  EXPECT_EQ(counts.at("/ground_truth/cam_back/dynamic_mask/compressed"), countOf("CAM_BACK"));
  EXPECT_EQ(counts.count("/ground_truth/dynamic_mask/compressed"), 0U);
}

TEST_F(SceneConverterLimits, ConvertsOnlyTheChosenChannels) {
  const std::vector<dataset::InstanceMask> masks = readInstanceMasks(tables_);
  ConvertOptions options;
  options.masks = &masks;
  options.channels = {"RADAR_FRONT", "RADAR_BACK_LEFT"};
  const ConvertSummary summary = convert(options);
  EXPECT_EQ(summary.radar_files, countOf("RADAR_FRONT") + countOf("RADAR_BACK_LEFT"));
  const auto counts = BagReader(summary.file).counts();
  EXPECT_EQ(counts.at("/radar_front"), countOf("RADAR_FRONT"));
  EXPECT_EQ(counts.at("/radar_back_left"), countOf("RADAR_BACK_LEFT"));
  for (const char* topic : {"/radar_front_left", "/cam_front/image/compressed", "/cam_front/camera_info",
                            "/lidar_top", "/ground_truth/dynamic_mask/compressed"}) {
    EXPECT_EQ(counts.count(topic), 0U) << topic;
  }
  EXPECT_EQ(counts.count("/ground_truth/odom"), 1U);
}

TEST_F(SceneConverterLimits, NamesTheChannelsWhenOneIsUnknown) {
  ConvertOptions options;
  options.channels = {"RADAR_FRONT", "RADAR_ROOF"};
  test::expectRefusal<std::exception>([&] { convert(options); }, {"RADAR_ROOF", "RADAR_BACK_LEFT, "});
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(SceneConverterLimits, RefusesADatarootWithoutAnyFile) {
  fs::remove_all(fixture_.dataroot() / "samples");
  fs::remove_all(fixture_.dataroot() / "sweeps");
  test::expectRefusal<std::exception>([&] { convert(); }, {fixture_.dataroot().string()});
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(SceneConverterLimits, WorksWithoutCanBusAnnotationsAndMasks) {
  fs::remove_all(fixture_.dataroot() / "can_bus");
  dataset::LoadOptions load;
  load.annotations = false;
  tables_ = Tables::load(fixture_.dataroot(), load);
  const auto counts = BagReader(convert().file).counts();
  for (const char* topic : {"/can/imu", "/can/wheel_speed", "/ground_truth/boxes"}) {
    EXPECT_EQ(counts.count(topic), 0U) << topic;
  }
  EXPECT_EQ(counts.at("/radar_front"), countOf("RADAR_FRONT"));
}

TEST_F(SceneConverterLimits, OverwritesOnlyWhenAsked) {
  test::writeFile(bagPath(), "precious");
  test::expectRefusal<std::exception>([&] { convert(); }, {bagPath().string()});
  EXPECT_EQ(test::readFile(bagPath()), "precious");
  ConvertOptions options;
  options.overwrite = true;
  const ConvertSummary summary = convert(options);
  EXPECT_EQ(BagReader(bagPath()).view().size(), summary.messages);
}

TEST_F(SceneConverterLimits, LeavesNothingAfterABadFile) {
  for (const auto& [channel, content] : {std::pair("RADAR_FRONT", "no point cloud"),
                                         {"CAM_FRONT", ""},
                                         {"CAM_FRONT", "version https://git-lfs"},
                                         {"LIDAR_TOP", "twenty bytes of text"}}) {
    const fs::path bad = fileOf(channel, 0);
    const std::string good = test::readFile(bad);
    test::writeFile(bad, content);
    test::expectRefusal<dataset::DatasetError>([this] { convert(); }, {bad.string()});
    EXPECT_TRUE(fs::is_empty(folder_.path()));
    test::writeFile(bad, good);
  }
}

TEST_F(SceneConverterLimits, LeavesNothingWhenInterrupted) {
  struct Interrupted {};
  std::size_t in_all = 0;
  bool grew = false;
  EXPECT_THROW(convert({},
                       [&](std::size_t done, std::size_t total) {
                         in_all = total;
                         grew = !fs::is_empty(folder_.path());
                         if (done > total / 2) throw Interrupted{};
                       }),
               Interrupted);
  EXPECT_GT(in_all, countOf("RADAR_FRONT"));
  EXPECT_TRUE(grew);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(SceneConverterLimits, ReportsProgressUpToTheEnd) {
  std::size_t last = 0;
  std::size_t in_all = 0;
  convert({}, [&](std::size_t done, std::size_t total) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, total);
    last = done;
    in_all = total;
  });
  EXPECT_EQ(last, in_all);
  EXPECT_GT(in_all, 0U);
}

TEST_F(SceneConverterLimits, NamesTheFolderThatCannotBeWritten) {
  test::writeFile(folder_.path() / "file", "a regular file is no folder");
  for (const fs::path& folder : {folder_.path() / "file", folder_.path() / "file/below", fs::path("/proc")})
    test::expectRefusal<std::exception>([&] { convertScene(tables_, 0, folder); }, {folder.string()});
}

TEST_F(SceneConverterLimits, ASceneCannotNameAFileElsewhere) {
  tables_.scenes[0].name = "../elsewhere";
  test::expectRefusal<std::exception>([&] { convert(); }, {"../elsewhere"});
  EXPECT_FALSE(fs::exists(folder_.path() / "../elsewhere.bag"));
}

TEST_F(SceneConverterLimits, CompressedBagsHoldTheSame) {
  const auto read = [&](Compression compression) {
    ConvertOptions options;
    options.overwrite = true;
    options.compression = compression;
    BagReader bag(convert(options).file);
    std::string content;
    for (const rosbag::MessageInstance& message : bag.view()) {
      std::string bytes(message.size(), '\0');
      ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()), message.size());
      message.write(stream);
      content += message.getTopic() + std::to_string(message.getTime().toNSec()) + bytes;
    }
    return content;
  };
  const std::string expected = read(Compression::kNone);
  const std::uintmax_t plain_bytes = fs::file_size(bagPath());
  for (const Compression compression : {Compression::kLz4, Compression::kBz2}) {
    EXPECT_TRUE(read(compression) == expected);
    EXPECT_LT(fs::file_size(bagPath()), plain_bytes);
  }
}

}  // namespace
}  // namespace radar_dot::bag
