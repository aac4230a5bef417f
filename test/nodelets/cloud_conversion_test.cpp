// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/cloud_conversion.h"

#include <gtest/gtest.h>

#include <cstring>

#include "fixtures/refusal.h"

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
