// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/pcl/radar_point.h"

#include <gtest/gtest.h>
#include <pcl_conversions/pcl_conversions.h>

#include <cmath>
#include <string>
#include <vector>

#include "nodelets/float_cloud.h"
#include "nodelets/messages/cloud_conversion.h"

namespace radar_dot {
namespace {

constexpr float kResiduals[] = {0.25F, -2.0F};

/// radar/dynamic of a radar that sends these fields of two returns.
sensor_msgs::PointCloud2 dynamicCloud(const sensor_msgs::PointCloud2& sent) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(sent, fields);
  std::vector<DopplerReturn> returns(2);
  returns[0].doppler = -3.5F;
  returns[1].doppler = 7.0F;
  returns[1].index = 1;
  const ReturnLabel labels[] = {ReturnLabel::kDynamic, ReturnLabel::kDynamic};
  return labelledCloud(sent, view, returns, kResiduals, labels, ReturnLabel::kDynamic);
}

/// What PCL makes of it. @param said  what PCL writes on the terminal
pcl::PointCloud<RadarPoint> byPcl(const sensor_msgs::PointCloud2& message, std::string& said) {
  pcl::PointCloud<RadarPoint> cloud;
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  pcl::fromROSMsg(message, cloud);
  said = ::testing::internal::GetCapturedStderr() + ::testing::internal::GetCapturedStdout();
  return cloud;
}

sensor_msgs::PointCloud2 fullCloud() {
  auto sent = test::floatCloud({"vx", "x", "y", "z", "rcs", "snr"},
                               {-1.F, 10.F, -2.F, 0.5F, 8.F, 20.F, -4.F, 30.F, 4.F, -1.F, -6.F, 9.F});
  sent.header.frame_id = "radar";
  sent.header.stamp = ros::Time(12, 345000);
  return sent;
}

TEST(RadarPoint, HasTheValuesOfTheMessage) {
  std::string said;
  const pcl::PointCloud<RadarPoint> cloud = byPcl(dynamicCloud(fullCloud()), said);
  EXPECT_EQ(said, "");
  EXPECT_EQ(cloud.header.frame_id, "radar");
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud[0].getVector4fMap(), Eigen::Vector4f(10.F, -2.F, 0.5F, 1.F));
  EXPECT_EQ(cloud[1].getVector3fMap(), Eigen::Vector3f(30.F, 4.F, -1.F));
  EXPECT_EQ(cloud[0].doppler, -3.5F);
  EXPECT_EQ(cloud[1].doppler, 7.0F);
  EXPECT_EQ(cloud[1].residual, -2.0F);
  EXPECT_EQ(cloud[1].rcs, -6.0F);
}

TEST(RadarPoint, TakesCloudsWithoutTheFieldsThatARadarMayLack) {
  std::string said;
  const auto planar =
      byPcl(dynamicCloud(test::floatCloud({"x", "y", "vr"}, {10.F, -2.F, 1.F, 30.F, 4.F, 1.F})), said);
  EXPECT_EQ(said, "");
  EXPECT_EQ(planar[1].getVector4fMap(), Eigen::Vector4f(30.F, 4.F, 0.F, 1.F));
  EXPECT_EQ(planar[0].residual, 0.25F);
  EXPECT_TRUE(std::isnan(planar[0].rcs));

  sensor_msgs::PointCloud2 bytes = fullCloud();
  bytes.fields[4].datatype = sensor_msgs::PointField::INT8;
  const auto other_rcs = byPcl(dynamicCloud(bytes), said);
  EXPECT_EQ(said, "");
  EXPECT_TRUE(std::isnan(other_rcs[0].rcs));
  EXPECT_EQ(other_rcs[0].z, 0.5F);
  EXPECT_TRUE(byPcl(dynamicCloud(fullCloud()), said)[0].rcs == 8.F);
}

TEST(RadarPoint, HasTheRangeRateAsUsedWhereTheRadarSendsOneOfThatName) {
  sensor_msgs::PointCloud2 sent = fullCloud();
  sent.fields[0].name = "doppler";
  sent.fields[5].name = "residual";
  std::string said;
  const auto cloud = byPcl(dynamicCloud(sent), said);
  EXPECT_EQ(said, "");
  EXPECT_EQ(cloud[1].doppler, 7.0F);
  EXPECT_EQ(cloud[1].residual, -2.0F);
}

TEST(RadarPoint, IsNotSilentAboutOtherClouds) {
  std::string said;
  byPcl(fullCloud(), said);
  for (const char* field : {"doppler", "residual"})
    EXPECT_NE(said.find(std::string("no field '") + field), std::string::npos) << said;
  EXPECT_EQ(said.find("'x'"), std::string::npos) << said;
  sensor_msgs::PointCloud2 wide = fullCloud();
  wide.fields[3].datatype = sensor_msgs::PointField::FLOAT64;
  byPcl(dynamicCloud(wide), said);
  EXPECT_NE(said.find("no field 'z' of type float32"), std::string::npos) << said;
}

TEST(RadarPoint, GoesBackIntoAMessageThatEgoVelocityReads) {
  std::string said;
  sensor_msgs::PointCloud2 message;
  pcl::toROSMsg(byPcl(dynamicCloud(fullCloud()), said), message);
  EXPECT_EQ(message.header.stamp, ros::Time(12, 345000)) << "PCL has microseconds";
  std::vector<PointField> fields;
  std::vector<DopplerReturn> returns;
  DopplerExtractor extractor;
  EXPECT_EQ(extractor.extract(viewOf(message, fields), returns).accepted, 2U);
  EXPECT_EQ(extractor.dopplerSource(), "field 'doppler'");
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_EQ(returns[0].doppler, -3.5F);
  EXPECT_EQ(returns[1].range, std::sqrt(900.F + 16.F + 1.F));
  EXPECT_EQ(fieldNames(fields), "x, y, z, doppler, residual, rcs");
}

}  // namespace
}  // namespace radar_dot
