// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/cloud_conversion.h"

#include <gtest/gtest.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>
#include <map>

#include "fixtures/definition_sum.h"
#include "fixtures/refusal.h"
#include "nodelets/float_cloud.h"
#include "nodelets/messages/radar_message.h"
#include "nodelets/messages/radar_scan.h"

namespace radar_dot {
namespace {

// An organised cloud of 2 rows by 3 points of x, y and a byte, with padded rows.
sensor_msgs::PointCloud2 organisedCloud() {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.frame_id = "radar";
  cloud.header.stamp = ros::Time(12, 34);
  for (const char* name : {"x", "y", "tag"}) {
    sensor_msgs::PointField& field = cloud.fields.emplace_back();
    field.name = name;
    field.offset = 4 * static_cast<std::uint32_t>(cloud.fields.size() - 1);
    field.datatype =
        cloud.fields.size() < 3 ? sensor_msgs::PointField::FLOAT32 : sensor_msgs::PointField::UINT8;
    field.count = 1;
  }
  cloud.width = 3;
  cloud.height = 2;
  cloud.point_step = 9;
  cloud.row_step = 32;
  cloud.data.resize(64);
  for (std::size_t i = 0; i < cloud.data.size(); ++i) cloud.data[i] = static_cast<std::uint8_t>(i);
  return cloud;
}

TEST(ViewOf, CoversPaddedRows) {
  const sensor_msgs::PointCloud2 cloud = organisedCloud();
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  EXPECT_EQ(view.size(), 6U);
  EXPECT_EQ(fieldNames(fields), "x, y, tag");
  EXPECT_EQ(view.point(4)[8], 32 + 9 + 8);
}

TEST(ViewOf, RefusesSizesThatContradictEachOther) {
  const auto refused = [](auto change) {
    sensor_msgs::PointCloud2 cloud = organisedCloud();
    change(cloud);
    std::vector<PointField> fields;
    return test::refusalOf([&] { viewOf(cloud, fields); }) != "accepted";
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& cloud) { cloud.data.pop_back(); }));
  EXPECT_TRUE(refused([](auto& cloud) { cloud.point_step = 0; }));
  EXPECT_TRUE(refused([](auto& cloud) { cloud.row_step = 26; }));
  EXPECT_TRUE(refused([](auto& cloud) { cloud.is_bigendian = 1; }));
  EXPECT_TRUE(refused([](auto& cloud) {
    cloud.width = cloud.height = 0xFFFFFFFF;
    cloud.row_step = 0xFFFFFFFF;
  }));
  EXPECT_FALSE(refused([](auto& cloud) {
    cloud.width = cloud.row_step = 0;
    cloud.data.clear();
    cloud.fields.clear();
  })) << "an empty cloud is normal";
  EXPECT_FALSE(refused([](auto& cloud) {
    cloud.height = 1;
    cloud.row_step = 0;
  })) << "one row needs no row_step";
}

/// The value of one field of a point.
double valueOf(const sensor_msgs::PointCloud2& cloud, const std::string& name, std::size_t index) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  const PointField* field = findField(fields, name);
  if (field == nullptr) throw std::invalid_argument("no field " + name + " among " + fieldNames(fields));
  return readScalar(view.point(index) + field->offset, field->type);
}

sensor_msgs::PointCloud2ConstPtr withPositions(const sensor_msgs::PointCloud2& cloud, AngleUnit unit,
                                               std::vector<std::string>& faults) {
  return radar_dot::withPositions(boost::make_shared<sensor_msgs::PointCloud2>(cloud), unit, faults);
}

// 10 m away, 30 degrees to the left, 45 degrees up: z = 10 sin 45, and 10 cos 45 in the plane.
TEST(WithPositions, GivesPolarCloudsXYZBehindTheirFields) {
  const double flat = 10.0 * std::sqrt(0.5);
  std::vector<std::string> faults;
  const auto radians = withPositions(test::floatCloud({"Elevation", "doppler", "r", "azimuth_angle"},
                                                      {0.F, -1.F, 2.F, 0.F, static_cast<float>(M_PI / 4.0),
                                                       -3.F, 10.F, static_cast<float>(M_PI / 6.0)}),
                                     AngleUnit::kRadians, faults);
  auto sent =
      test::floatCloud({"AzimuthAngle", "Range", "ElevationAngle"}, {0.F, 2.F, 0.F, 30.F, 10.F, 45.F});
  sent.width = 1;  // a row each, with a gap between them
  sent.height = 2;
  sent.data.insert(sent.data.begin() + 12, 4, 0xFF);
  sent.row_step = 16;
  sent.data.resize(32);
  const auto degrees = withPositions(sent, AngleUnit::kDegrees, faults);
  EXPECT_TRUE(faults.empty());
  for (const sensor_msgs::PointCloud2ConstPtr& cloud : {radians, degrees}) {
    ASSERT_EQ(cloud->width * cloud->height, 2U);
    EXPECT_NEAR(valueOf(*cloud, "x", 0), 2.0, 1e-6);
    EXPECT_NEAR(valueOf(*cloud, "y", 0), 0.0, 1e-6);
    EXPECT_NEAR(valueOf(*cloud, "x", 1), flat * std::cos(M_PI / 6.0), 1e-5);
    EXPECT_NEAR(valueOf(*cloud, "y", 1), flat * 0.5, 1e-5);
    EXPECT_NEAR(valueOf(*cloud, "z", 1), flat, 1e-5);
  }
  EXPECT_EQ(valueOf(*radians, "doppler", 1), -3.0);
  EXPECT_EQ(valueOf(*degrees, "Range", 1), 10.0);

  const auto planar =
      withPositions(test::floatCloud({"range", "azimuth"}, {5.F, -0.5F}), AngleUnit::kRadians, faults);
  EXPECT_NEAR(valueOf(*planar, "y", 0), -5.0 * std::sin(0.5), 1e-6);
  EXPECT_EQ(valueOf(*planar, "z", 0), 0.0);
}

TEST(WithPositions, LeavesOtherCloudsAlone) {
  std::vector<std::string> faults;
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"X", "Y", "range", "azimuth"}, {"range", "alpha"}, {"azimuth", "doppler"}}) {
    const auto sent = boost::make_shared<sensor_msgs::PointCloud2>(
        test::floatCloud(names, std::vector<float>(names.size())));
    EXPECT_EQ(radar_dot::withPositions(sent, AngleUnit::kRadians, faults), sent) << names[0];
  }
  withPositions(sensor_msgs::PointCloud2(), AngleUnit::kRadians, faults);
  EXPECT_TRUE(faults.empty());
}

TEST(WithPositions, NamesWhatIsWrongWithPolarFields) {
  std::vector<std::string> faults;
  const sensor_msgs::PointCloud2 cloud =
      test::floatCloud({"range", "azimuth"}, {5.F, -30.F, 6.F, 45.F, 7.F, 1.F});
  withPositions(cloud, AngleUnit::kRadians, faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0], "field 'azimuth' has angles of more than a turn: set angle_unit to degrees");
  sensor_msgs::PointCloud2 beyond = cloud;
  beyond.fields[0].offset = 6;
  withPositions(beyond, AngleUnit::kDegrees, faults);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[1], "field 'range' (offset 6, type 7) does not fit into points of 8 bytes");
}

TEST(KeptCloud, OneRowBecomesShorter) {
  sensor_msgs::PointCloud2 cloud = organisedCloud();
  cloud.height = 1;
  cloud.row_step = 0;  // as many drivers leave it
  const auto kept = keptCloud(cloud, {1, 0, 1});
  EXPECT_EQ(kept->header.stamp, cloud.header.stamp);
  EXPECT_EQ(kept->width, 2U);
  EXPECT_EQ(kept->row_step, 18U);
  EXPECT_EQ(kept->fields, cloud.fields);
  std::vector<std::uint8_t> expected(cloud.data.begin(), cloud.data.begin() + 9);
  expected.insert(expected.end(), cloud.data.begin() + 18, cloud.data.begin() + 27);
  EXPECT_EQ(kept->data, expected);
  EXPECT_EQ(keptCloud(cloud, {0, 0, 0})->width, 0U);
  EXPECT_EQ(keptCloud(sensor_msgs::PointCloud2(), {})->width, 0U);
}

// Two padded rows of x (a double), y, z and a byte.
TEST(KeptCloud, OrganisedPointsLoseTheirPositionAlone) {
  sensor_msgs::PointCloud2 cloud = organisedCloud();
  cloud.is_dense = 1;
  test::expectRefusal([&] { keptCloud(cloud, {1, 1, 1, 1, 0, 1}); }, {"field z", "organised"});
  cloud.fields[2].name = "z";
  test::expectRefusal([&] { keptCloud(cloud, {1, 1, 1, 1, 0, 1}); }, {"field z", "no float"});
  cloud.fields[0].datatype = sensor_msgs::PointField::FLOAT64;
  cloud.fields[1].offset = 8;
  cloud.fields[2].offset = 12;
  cloud.fields[2].datatype = sensor_msgs::PointField::FLOAT32;
  cloud.point_step = 17;
  cloud.row_step = 56;
  cloud.data.assign(112, 7);
  const auto kept = keptCloud(cloud, {1, 1, 1, 1, 0, 1});
  EXPECT_EQ(kept->is_dense, 0);
  EXPECT_EQ(kept->width, 3U);
  EXPECT_EQ(kept->height, 2U);
  for (const char* name : {"x", "y", "z"}) EXPECT_TRUE(std::isnan(valueOf(*kept, name, 4))) << name;
  std::fill_n(kept->data.begin() + 56 + 17, 16, 7);
  EXPECT_EQ(kept->data, cloud.data) << "all else is untouched";
  EXPECT_EQ(keptCloud(cloud, {1, 1, 1, 1, 1, 1})->is_dense, 1);
}

/// What a subscriber gets of a message that a publisher of this type and md5sum sends.
RadarMessage receive(const ros::SerializedMessage& sent, const std::string& type, const std::string& md5sum,
                     std::size_t cut = 0) {
  ros::serialization::PreDeserializeParams<RadarMessage> params;
  params.message = boost::make_shared<RadarMessage>();
  params.connection_header = boost::make_shared<std::map<std::string, std::string>>();
  (*params.connection_header)["type"] = type;
  (*params.connection_header)["md5sum"] = md5sum;
  ros::serialization::PreDeserialize<RadarMessage>::notify(params);
  ros::serialization::IStream stream(sent.message_start,
                                     static_cast<std::uint32_t>(sent.num_bytes - 4 - cut));
  ros::serialization::deserialize(stream, *params.message);
  EXPECT_EQ(stream.getLength(), 0U);
  return *params.message;
}

template <typename Message>
RadarMessage receive(const Message& sent, std::size_t cut = 0) {
  return receive(ros::serialization::serializeMessage(sent), ros::message_traits::datatype(sent),
                 ros::message_traits::md5sum(sent), cut);
}

TEST(RadarMessage, TakesAPointCloud2AsItIs) {
  const sensor_msgs::PointCloud2 sent = organisedCloud();
  const RadarMessage received = receive(sent);
  EXPECT_EQ(received.defect, "");
  EXPECT_EQ(received.type, "sensor_msgs/PointCloud2");
  EXPECT_EQ(received.header.stamp, sent.header.stamp);
  EXPECT_EQ(*received.cloud, sent);
}

// The layout of the Oculii Eagle, with a channel whose name was left out.
sensor_msgs::PointCloud pointsWithChannels() {
  sensor_msgs::PointCloud cloud;
  cloud.header.frame_id = "eagle";
  cloud.header.stamp = ros::Time(5, 6);
  cloud.points.resize(2);
  cloud.points[1].x = 3.F;
  cloud.points[1].z = -1.F;
  cloud.channels.resize(2);
  cloud.channels[0].name = "Doppler";
  cloud.channels[0].values = {-1.F, -2.F};
  cloud.channels[1].values = {4.F, 5.F};
  return cloud;
}

TEST(RadarMessage, MakesFieldsOfTheChannelsOfAPointCloud) {
  const RadarMessage received = receive(pointsWithChannels());
  EXPECT_EQ(received.defect, "");
  EXPECT_EQ(received.header.frame_id, "eagle");
  ASSERT_EQ(received.cloud->width, 2U);
  EXPECT_EQ(received.cloud->header.stamp, ros::Time(5, 6));
  EXPECT_EQ(valueOf(*received.cloud, "x", 1), 3.0);
  EXPECT_EQ(valueOf(*received.cloud, "z", 1), -1.0);
  EXPECT_EQ(valueOf(*received.cloud, "Doppler", 0), -1.0);
  EXPECT_EQ(valueOf(*received.cloud, "Doppler", 1), -2.0);
  EXPECT_EQ(valueOf(*received.cloud, "channel1", 1), 5.0);

  sensor_msgs::PointCloud uneven = pointsWithChannels();
  uneven.channels[1].values.pop_back();
  const RadarMessage refused = receive(uneven);
  EXPECT_EQ(refused.cloud, nullptr);
  EXPECT_EQ(refused.header.frame_id, "eagle");
  EXPECT_EQ(refused.defect, "channel 1 '' has 1 values for 2 points");
}

radar_msgs::RadarScan radarScan() {
  radar_msgs::RadarScan scan;
  scan.header.frame_id = "front";
  scan.header.stamp = ros::Time(7, 8);
  scan.returns = {{2.F, 0.F, 0.F, -3.F, 9.F}, {10.F, static_cast<float>(M_PI / 2.0), 0.F, 4.F, 8.F}};
  return scan;
}

TEST(RadarMessage, PlacesTheReturnsOfARadarScan) {
  const RadarMessage received = receive(radarScan());
  EXPECT_EQ(received.defect, "");
  EXPECT_EQ(received.header.stamp, ros::Time(7, 8));
  ASSERT_EQ(received.cloud->width, 2U);
  EXPECT_EQ(received.cloud->header.frame_id, "front");
  EXPECT_NEAR(valueOf(*received.cloud, "x", 0), 2.0, 1e-6);
  EXPECT_NEAR(valueOf(*received.cloud, "y", 1), 10.0, 1e-5) << "positive azimuths are to the left";
  EXPECT_EQ(valueOf(*received.cloud, "doppler_velocity", 1), 4.0);
  EXPECT_EQ(valueOf(*received.cloud, "amplitude", 1), 8.0);
  radar_msgs::RadarScan degrees = radarScan();
  for (radar_msgs::RadarReturn& seen : degrees.returns) seen.azimuth = 40.F;
  EXPECT_NE(receive(degrees).defect, "");
  EXPECT_EQ(receive(radar_msgs::RadarScan()).cloud->width, 0U);
}

TEST(RadarMessage, TheSumOfRadarScanIsThatOfItsDefinition) {
  EXPECT_EQ(test::sumOfDefinition<std_msgs::Header>(), ros::message_traits::md5sum<std_msgs::Header>());
  EXPECT_EQ(test::sumOfDefinition<radar_msgs::RadarScan>(),
            ros::message_traits::md5sum<radar_msgs::RadarScan>());
}

TEST(RadarMessage, NamesATypeThatIsNotTaken) {
  const RadarMessage laser = receive(sensor_msgs::LaserScan());
  EXPECT_EQ(laser.cloud, nullptr);
  for (const char* part : {"sensor_msgs/LaserScan", "sensor_msgs/PointCloud2", "sensor_msgs/PointCloud ",
                           "radar_msgs/RadarScan", "scripts/radar_lists_to_cloud"}) {
    EXPECT_NE(laser.defect.find(part), std::string::npos) << part << " in: " << laser.defect;
  }
  const RadarMessage other =
      receive(ros::serialization::serializeMessage(radarScan()), "radar_msgs/RadarScan", "0123456789abcdef");
  EXPECT_EQ(other.cloud, nullptr);
  EXPECT_EQ(other.defect,
            "this is another version of radar_msgs/RadarScan: its md5sum is 0123456789abcdef, must be "
            "6dfacef1e665538dbd8e159d5ce7a97a");
}

TEST(RadarMessage, ThrowsOfDataThatEndTooEarly) {
  EXPECT_THROW(receive(organisedCloud(), 10), ros::serialization::StreamOverrunException);
  EXPECT_THROW(receive(pointsWithChannels(), 10), ros::serialization::StreamOverrunException);
  EXPECT_THROW(receive(radarScan(), 10), ros::serialization::StreamOverrunException);
}

TEST(LabelledCloud, KeepsEveryByteAndAppendsDopplerAndResidual) {
  const sensor_msgs::PointCloud2 cloud = organisedCloud();
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  std::vector<DopplerReturn> returns(3);
  returns[0].index = 1;
  returns[1].index = 2;
  returns[2].index = 4;
  for (std::size_t i = 0; i < 3; ++i) returns[i].doppler = static_cast<float>(i) + 0.5F;
  const float residuals[] = {0.1F, -2.0F, 0.3F};
  const ReturnLabel labels[] = {ReturnLabel::kStatic, ReturnLabel::kDynamic, ReturnLabel::kStatic};

  const sensor_msgs::PointCloud2 result =
      labelledCloud(cloud, view, returns, residuals, labels, ReturnLabel::kStatic);
  EXPECT_EQ(result.header.frame_id, "radar");
  EXPECT_EQ(result.header.stamp, cloud.header.stamp);
  ASSERT_EQ(result.width, 2U);
  EXPECT_EQ(result.height, 1U);
  EXPECT_EQ(result.point_step, 17U);
  ASSERT_EQ(result.fields.size(), 5U);
  EXPECT_EQ(result.fields[3].name, "doppler");
  EXPECT_EQ(result.fields[4].name, "residual");
  EXPECT_EQ(result.fields[4].offset, 13U);
  EXPECT_EQ(std::memcmp(&result.data[0], &cloud.data[9], 9), 0);
  EXPECT_EQ(std::memcmp(&result.data[17], &cloud.data[32 + 9], 9), 0) << "a point of the second, padded row";
  float doppler = 0.F, residual = 0.F;
  std::memcpy(&doppler, &result.data[17 + 9], 4);
  std::memcpy(&residual, &result.data[17 + 13], 4);
  EXPECT_EQ(doppler, 2.5F);
  EXPECT_EQ(residual, 0.3F);
  EXPECT_EQ(labelledCloud(cloud, view, returns, residuals, labels, ReturnLabel::kDynamic).width, 1U);
}

TEST(LabelledCloud, DoesNotShadowFieldsOfTheSameName) {
  sensor_msgs::PointCloud2 cloud = organisedCloud();
  cloud.fields[1].name = "doppler";
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  const sensor_msgs::PointCloud2 result =
      labelledCloud(cloud, view, {}, nullptr, nullptr, ReturnLabel::kStatic);
  EXPECT_EQ(result.fields[1].name, "doppler");
  EXPECT_EQ(result.fields[3].name, "ego_doppler");
  EXPECT_EQ(result.fields[4].name, "residual");
}

}  // namespace
}  // namespace radar_dot
