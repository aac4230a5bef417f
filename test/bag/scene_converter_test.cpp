// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/scene_converter.h"

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>
#include <vector>

#include "bag/bag_reading.h"
#include "fixtures/nuscenes_fixture.h"
#include "radar_dot/bag/messages.h"
#include "radar_dot/dataset/can_bus.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;
using dataset::Index;
using dataset::Tables;
using test::microseconds;
using test::NuscenesFixture;

std::string topicOf(const std::string& channel) { return "/" + frameOf(channel); }

/// The type PCD calls by letter and size, as sensor_msgs/PointField numbers it.
std::uint8_t datatypeOf(char type, std::size_t size) {
  const std::map<std::pair<char, std::size_t>, std::uint8_t> types = {
      {{'I', 1}, 1}, {{'U', 1}, 2}, {{'I', 2}, 3}, {{'U', 2}, 4},
      {{'I', 4}, 5}, {{'U', 4}, 6}, {{'F', 4}, 7}, {{'F', 8}, 8}};
  return types.at({type, size});
}

void expectSameFields(const sensor_msgs::PointCloud2& cloud, const test::RawPcd& pcd) {
  ASSERT_EQ(cloud.fields.size(), pcd.fields.size());
  ASSERT_EQ(cloud.width, pcd.points);
  ASSERT_EQ(cloud.height, 1U);
  ASSERT_EQ(cloud.row_step, cloud.width * cloud.point_step);
  ASSERT_EQ(cloud.data.size(), cloud.row_step);
  EXPECT_FALSE(cloud.is_dense);
  for (std::size_t f = 0; f < pcd.fields.size(); ++f) {
    const test::RawPcd::Field& expected = pcd.fields[f];
    const sensor_msgs::PointField& found = cloud.fields[f];
    ASSERT_EQ(found.name, expected.name);
    ASSERT_EQ(found.datatype, datatypeOf(expected.type, expected.size));
    ASSERT_EQ(found.count, 1U);
    for (std::size_t i = 0; i < pcd.points; ++i) {
      ASSERT_EQ(std::memcmp(&cloud.data[i * cloud.point_step + found.offset],
                            &pcd.data[i * pcd.record + expected.offset], expected.size),
                0)
          << expected.name << " of point " << i;
    }
  }
}

/// Every file of a channel that is on disk is one message with its stamp; `check` compares the rest.
template <typename Message, typename Check>
void expectAllFiles(test::BagReader& bag, const Tables& tables, Index scene, const std::string& channel,
                    const std::string& topic, Check&& check) {
  std::vector<const dataset::SampleData*> present;
  for (const Index reading : tables.readingsOf(scene, channel)) {
    const dataset::SampleData& row = at(tables.sample_data, reading);
    if (fs::exists(tables.path(row))) present.push_back(&row);
  }
  const auto messages = bag.messages<Message>(topic);
  ASSERT_EQ(messages.size(), present.size()) << topic;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    SCOPED_TRACE(tables.path(*present[i]).string());
    ASSERT_EQ(microseconds(messages[i]->header.stamp), present[i]->timestamp_us);
    ASSERT_EQ(messages[i]->header.frame_id, frameOf(channel));
    check(*messages[i], *present[i]);
    if (testing::Test::HasFatalFailure()) return;
  }
}

void expectAllRadarFiles(test::BagReader& bag, const Tables& tables, Index scene) {
  std::size_t radars = 0;
  for (const std::string& channel : tables.channelsOf(scene)) {
    if (channel.rfind("RADAR", 0) != 0) continue;
    ++radars;
    expectAllFiles<sensor_msgs::PointCloud2>(
        bag, tables, scene, channel, topicOf(channel),
        [&tables](const sensor_msgs::PointCloud2& cloud, const dataset::SampleData& row) {
          expectSameFields(cloud, test::readRawPcd(tables.path(row)));
        });
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_EQ(radars, 5U);
}

/// The stamp inside a message, us.
std::int64_t stampOf(const rosbag::MessageInstance& message) {
  if (const auto boxes = message.instantiate<visualization_msgs::MarkerArray>()) {
    return microseconds(boxes->markers.at(0).header.stamp);
  }
  if (const auto mounts = message.instantiate<tf2_msgs::TFMessage>()) {
    return microseconds(mounts->transforms.at(0).header.stamp);
  }
  // Every other type begins with its header: sequence number, seconds, nanoseconds.
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  std::uint32_t header[3];
  std::memcpy(header, bytes.data(), sizeof header);
  return microseconds(ros::Time(header[1], header[2]));
}

void expectOrderOfTime(test::BagReader& bag) {
  std::int64_t last = 0;
  bool first = true;
  for (const rosbag::MessageInstance& message : bag.view()) {
    ASSERT_EQ(message.getTopic() == "/tf_static", first) << message.getTopic();
    first = false;
    const std::int64_t time = microseconds(message.getTime());
    ASSERT_GE(time, last) << message.getTopic();
    ASSERT_EQ(time, stampOf(message)) << message.getTopic();
    last = time;
  }
}

void expectWithinSizeBar(const ConvertSummary& summary) {
  EXPECT_EQ(summary.bag_bytes, fs::file_size(summary.file));
  EXPECT_LE(static_cast<double>(summary.bag_bytes), 1.05 * static_cast<double>(summary.sensor_bytes) + 10e6);
}

/// Both scenes of the fixture, converted once for all tests.
class ConvertedFixture : public testing::TestWithParam<const char*> {
 protected:
  struct Converted {
    NuscenesFixture fixture;
    Tables tables = Tables::load(fixture.dataroot());
    std::vector<dataset::InstanceMask> masks = readInstanceMasks(tables);
    test::TemporaryFolder folder;
    std::map<std::string, ConvertSummary> summaries;
  };

  static void SetUpTestSuite() {
    converted_ = new Converted;
    ConvertOptions options;
    options.masks = &converted_->masks;
    for (const char* name : {NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene}) {
      converted_->summaries[name] = convertScene(converted_->tables, converted_->tables.findScene(name),
                                                 converted_->folder.path(), options);
    }
  }
  static void TearDownTestSuite() {
    delete converted_;
    converted_ = nullptr;
  }

  const Tables& tables() const { return converted_->tables; }
  Index scene() const { return tables().findScene(GetParam()); }
  const test::FixtureScene& truth() const { return converted_->fixture.scene(GetParam()); }
  int sampleCount() const { return converted_->fixture.options().samples_per_scene; }
  const ConvertSummary& summary() const { return converted_->summaries.at(GetParam()); }
  test::BagReader bag_{converted_->folder.path() / (std::string(GetParam()) + ".bag")};

 private:
  static Converted* converted_;
};

ConvertedFixture::Converted* ConvertedFixture::converted_ = nullptr;

TEST_P(ConvertedFixture, EveryRadarFieldEqualsTheFile) { expectAllRadarFiles(bag_, tables(), scene()); }

TEST_P(ConvertedFixture, MessagesAreInOrderOfTimeAtTheirStamps) { expectOrderOfTime(bag_); }

TEST_P(ConvertedFixture, SummaryTellsWhatTheBagHolds) {
  EXPECT_EQ(summary().messages, bag_.view().size());
  std::size_t radar_files = 0;
  for (const auto& [topic, count] : bag_.counts()) {
    if (topic.rfind("/radar", 0) == 0) radar_files += count;
  }
  EXPECT_EQ(summary().radar_files, radar_files);
  EXPECT_TRUE(summary().missing.empty());
  expectWithinSizeBar(summary());
}

TEST_P(ConvertedFixture, StaticTransformsAreTheCalibrationsAndLatched) {
  const auto messages = bag_.messages<tf2_msgs::TFMessage>("/tf_static");
  ASSERT_EQ(messages.size(), 1U);
  std::set<std::string> frames;
  for (const auto& transform : messages[0]->transforms) frames.insert(transform.child_frame_id);
  EXPECT_EQ(frames.size(), messages[0]->transforms.size());
  const std::vector<std::string> channels = tables().channelsOf(scene());
  EXPECT_EQ(frames.size(), channels.size());
  for (const std::string& channel : channels) {
    const dataset::SampleData& row = at(tables().sample_data, tables().readingsOf(scene(), channel).front());
    const Eigen::Isometry3d& T = at(tables().calibrated_sensors, row.calibrated_sensor).T_base_from_sensor;
    for (const auto& transform : messages[0]->transforms) {
      if (transform.child_frame_id != frameOf(channel)) continue;
      EXPECT_EQ(transform.header.frame_id, "base_link");
      EXPECT_EQ(transform.transform.translation.x, T.translation().x());
      EXPECT_EQ(transform.transform.translation.y, T.translation().y());
      EXPECT_EQ(transform.transform.translation.z, T.translation().z());
      const auto& q = transform.transform.rotation;
      EXPECT_NEAR(Eigen::Quaterniond(q.w, q.x, q.y, q.z).angularDistance(Eigen::Quaterniond(T.linear())), 0.0,
                  1e-7);
    }
  }
  for (const rosbag::ConnectionInfo* connection : bag_.view().getConnections()) {
    const auto latching = connection->header->find("latching");
    const bool latched = latching != connection->header->end() && latching->second == "1";
    EXPECT_EQ(latched, connection->topic == "/tf_static") << connection->topic;
    if (latched) {
      EXPECT_EQ(connection->header->at("vehicle"), "n001");
    }
  }
}

TEST_P(ConvertedFixture, PicturesAreTheBytesOfTheFiles) {
  expectAllFiles<sensor_msgs::CompressedImage>(
      bag_, tables(), scene(), "CAM_FRONT", "/cam_front/image/compressed",
      [this](const sensor_msgs::CompressedImage& image, const dataset::SampleData& row) {
        EXPECT_EQ(image.format, "jpeg");
        const std::string file = test::readFile(tables().path(row));
        EXPECT_TRUE(std::equal(image.data.begin(), image.data.end(), file.begin(), file.end(),
                               [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
      });
  expectAllFiles<sensor_msgs::CameraInfo>(
      bag_, tables(), scene(), "CAM_FRONT", "/cam_front/camera_info",
      [this](const sensor_msgs::CameraInfo& info, const dataset::SampleData& row) {
        const auto& K = at(tables().calibrated_sensors, row.calibrated_sensor).camera_matrix;
        ASSERT_TRUE(K.has_value());
        EXPECT_EQ(info.K[0], (*K)(0, 0));
        EXPECT_EQ(info.K[2], (*K)(0, 2));
        EXPECT_EQ(info.P[6], (*K)(1, 2));
        EXPECT_EQ(info.width, 1600U);
        EXPECT_EQ(info.height, 900U);
      });
}

TEST_P(ConvertedFixture, LidarPointsEqualTheFile) {
  expectAllFiles<sensor_msgs::PointCloud2>(
      bag_, tables(), scene(), "LIDAR_TOP", "/lidar_top",
      [this](const sensor_msgs::PointCloud2& cloud, const dataset::SampleData& row) {
        const std::string file = test::readFile(tables().path(row));
        ASSERT_EQ(cloud.width, static_cast<unsigned>(NuscenesFixture::kLidarPoints));
        const std::vector<std::string> names = {"x", "y", "z", "intensity", "ring"};
        ASSERT_EQ(cloud.fields.size(), names.size());
        for (std::size_t f = 0; f < names.size(); ++f) {
          EXPECT_EQ(cloud.fields[f].name, names[f]);
          EXPECT_EQ(cloud.fields[f].datatype, sensor_msgs::PointField::FLOAT32);
          for (std::size_t i = 0; i < cloud.width; ++i) {
            ASSERT_EQ(std::memcmp(&cloud.data[i * cloud.point_step + cloud.fields[f].offset],
                                  &file[20 * i + 4 * f], 4),
                      0);
          }
        }
      });
}

TEST_P(ConvertedFixture, OdometryFollowsTheDrive) {
  const auto messages = bag_.messages<nav_msgs::Odometry>("/ground_truth/odom");
  ASSERT_EQ(messages.size(), tables().egoPosesOf(scene()).size());
  const test::Drive& drive = truth().drive;
  for (const auto& odometry : messages) {
    ASSERT_EQ(odometry->header.frame_id, "map");
    ASSERT_EQ(odometry->child_frame_id, "base_link");
    const std::int64_t time = microseconds(odometry->header.stamp);
    const Eigen::Isometry3d T = drive.T_map_from_base(time);
    const auto& p = odometry->pose.pose.position;
    const auto& q = odometry->pose.pose.orientation;
    EXPECT_NEAR((Eigen::Vector3d(p.x, p.y, p.z) - T.translation()).norm(), 0.0, 1e-6);
    EXPECT_NEAR(Eigen::Quaterniond(q.w, q.x, q.y, q.z).angularDistance(Eigen::Quaterniond(T.linear())), 0.0,
                1e-6);
    EXPECT_NEAR(odometry->twist.twist.linear.x, drive.speed, 0.02);
    EXPECT_NEAR(odometry->twist.twist.linear.y, 0.0, drive.speed * std::abs(drive.yaw_rate) * 0.05 + 0.02);
    EXPECT_NEAR(odometry->twist.twist.angular.z, drive.yaw_rate, 1e-3);
  }
}

TEST_P(ConvertedFixture, CanMessagesFollowTheDrive) {
  const dataset::CanBus can = dataset::readCanBus(tables().dataroot(), GetParam());
  const auto wheels = bag_.messages<geometry_msgs::TwistWithCovarianceStamped>("/can/wheel_speed");
  ASSERT_EQ(wheels.size(), can.vehicle.size());
  ASSERT_FALSE(wheels.empty());
  for (const auto& wheel : wheels) {
    EXPECT_EQ(wheel->header.frame_id, "base_link");
    EXPECT_NEAR(wheel->twist.twist.linear.x, truth().drive.speed, 0.01);
  }
  const auto imu = bag_.messages<sensor_msgs::Imu>("/can/imu");
  ASSERT_EQ(imu.size(), can.imu.size());
  ASSERT_FALSE(imu.empty());
  for (std::size_t i = 0; i < imu.size(); ++i) {
    EXPECT_EQ(microseconds(imu[i]->header.stamp), can.imu[i].timestamp_us);
    EXPECT_EQ(imu[i]->header.frame_id, "base_link");
    EXPECT_NEAR(imu[i]->angular_velocity.z, truth().drive.yaw_rate, 1e-6);
    EXPECT_EQ(imu[i]->linear_acceleration.z, can.imu[i].linear_acceleration[2]);
    EXPECT_EQ(imu[i]->orientation.w, can.imu[i].orientation[0]);
    EXPECT_EQ(imu[i]->orientation_covariance[0], -1.0) << "no orientation for filters";
  }
}

TEST_P(ConvertedFixture, BoxesFollowTheInstances) {
  const auto messages = bag_.messages<visualization_msgs::MarkerArray>("/ground_truth/boxes");
  ASSERT_EQ(messages.size(), static_cast<std::size_t>(sampleCount()));
  std::map<int, int> uses;
  for (const auto& boxes : messages) {
    ASSERT_EQ(boxes->markers.size(), 3U);
    EXPECT_EQ(boxes->markers[0].action, visualization_msgs::Marker::DELETEALL);
    for (std::size_t i = 1; i < 3; ++i) {
      const visualization_msgs::Marker& box = boxes->markers[i];
      ++uses[box.id];
      EXPECT_EQ(box.header.frame_id, "map");
      EXPECT_EQ(box.type, visualization_msgs::Marker::CUBE);
      EXPECT_EQ(box.lifetime, ros::Duration(0.6));
      const bool moves = box.color.r > box.color.b;
      const test::MovingBox& expected = moves ? truth().moving_box : truth().parked_box;
      const Eigen::Vector3d centre =
          expected.T_map_from_box(truth().drive, microseconds(box.header.stamp)).translation();
      EXPECT_NEAR(box.pose.position.x, centre.x(), 1e-3);
      EXPECT_NEAR(box.pose.position.y, centre.y(), 1e-3);
      EXPECT_EQ(box.scale.x, expected.size.y());  // length
      EXPECT_EQ(box.scale.y, expected.size.x());  // width
      EXPECT_EQ(box.scale.z, expected.size.z());
    }
  }
  EXPECT_EQ(uses.size(), 2U) << "an instance keeps its number";
}

TEST_P(ConvertedFixture, MasksShowWhatMoves) {
  const auto masks = bag_.messages<sensor_msgs::CompressedImage>("/ground_truth/dynamic_mask/compressed");
  const auto images = bag_.messages<sensor_msgs::CompressedImage>("/cam_front/image/compressed");
  ASSERT_EQ(masks.size(), static_cast<std::size_t>(sampleCount()));
  ASSERT_EQ(images.size(), masks.size());
  const int* box = NuscenesFixture::kMovingPixels;
  cv::Mat expected = cv::Mat::zeros(NuscenesFixture::kImageRows, NuscenesFixture::kImageColumns, CV_8UC1);
  expected(cv::Rect(box[0], box[1], box[2], box[3])) = 255;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    EXPECT_EQ(masks[i]->header.stamp, images[i]->header.stamp);
    EXPECT_EQ(masks[i]->header.frame_id, "cam_front");
    EXPECT_EQ(masks[i]->format, "png");
    const cv::Mat mask = cv::imdecode(masks[i]->data, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(mask.type(), CV_8UC1);
    ASSERT_EQ(mask.size(), expected.size());
    EXPECT_EQ(cv::norm(mask, expected, cv::NORM_L1), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ConvertedFixture,
                         testing::Values(NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene));

TEST(ConvertedRealScene, HoldsEveryRadarFieldInOrderOfTime) {
  const fs::path dataroot = fs::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real";
  if (!fs::exists(dataroot)) GTEST_SKIP() << dataroot << " is not there";
  dataset::LoadOptions load;
  load.scenes = {"scene-0061"};
  Tables tables = Tables::load(dataroot, load);
  const std::vector<dataset::InstanceMask> masks = readInstanceMasks(tables);
  ConvertOptions options;
  options.masks = &masks;
  const test::TemporaryFolder folder;
  const ConvertSummary summary = convertScene(tables, 0, folder.path(), options);
  test::BagReader bag(summary.file);
  EXPECT_GT(summary.radar_files, 1200U);
  expectAllRadarFiles(bag, tables, 0);
  expectOrderOfTime(bag);
  expectWithinSizeBar(summary);
  EXPECT_EQ(bag.counts().count("/can/imu"), 1U);
  for (const auto& odometry : bag.messages<nav_msgs::Odometry>("/ground_truth/odom")) {
    EXPECT_LT(std::abs(odometry->twist.twist.linear.x), 15.0);
    EXPECT_LT(std::abs(odometry->twist.twist.linear.y), 1.0) << "a car does not drive sideways";
  }
}

}  // namespace
}  // namespace radar_dot::bag
