// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/cloud_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "fixtures/refusal.h"
#include "nodelets/float_cloud.h"

namespace radar_dot {
namespace {

using sensor_msgs::PointField;
using test::expectRefusal;
using test::floatCloud;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(PointsOf, ReadsPositionsByNameAndTheResidual) {
  const std::vector<CloudPoint> points =
      pointsOf(floatCloud({"residual", "z", "x", "y"}, {0.5F, 3.F, 1.F, 2.F, -0.25F, 6.F, 4.F, 5.F}));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].position, Eigen::Vector3f(1.F, 2.F, 3.F));
  EXPECT_EQ(points[0].residual, 0.5F);
  EXPECT_EQ(points[1].position, Eigen::Vector3f(4.F, 5.F, 6.F));
  EXPECT_EQ(points[1].residual, -0.25F);
}

TEST(PointsOf, OurResidualCountsWhereTheCloudHadOneBefore) {
  const std::vector<CloudPoint> points =
      pointsOf(floatCloud({"x", "y", "z", "residual", "ego_residual"}, {1.F, 2.F, 3.F, 9.F, 0.5F}));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].residual, 0.5F);
}

TEST(PointsOf, WithoutAResidualItIsNotANumber) {
  const std::vector<CloudPoint> points = pointsOf(floatCloud({"x", "y", "z", "rcs"}, {1.F, 2.F, 3.F, 4.F}));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].position, Eigen::Vector3f(1.F, 2.F, 3.F));
  EXPECT_TRUE(std::isnan(points[0].residual));
}

TEST(PointsOf, LeavesOutPointsThatAreNotFinite) {
  const std::vector<CloudPoint> points = pointsOf(floatCloud({"x", "y", "z"}, {kNaN, 2.F, 3.F,        //
                                                                               1.F, kInfinity, 3.F,   //
                                                                               1.F, 2.F, -kInfinity,  //
                                                                               7.F, 8.F, 9.F}));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].position, Eigen::Vector3f(7.F, 8.F, 9.F));
}

TEST(PositionsOf, HasAPlaceForEveryPoint) {
  const std::vector<Eigen::Vector3f> positions =
      positionsOf(floatCloud({"x", "y", "z"}, {kNaN, 2.F, 3.F, 7.F, 8.F, 9.F}));
  ASSERT_EQ(positions.size(), 2U);
  EXPECT_TRUE(std::isnan(positions[0].x()));
  EXPECT_EQ(positions[1], Eigen::Vector3f(7.F, 8.F, 9.F));
}

TEST(PointsOf, ReadsOtherTypesAndPaddedRows) {
  sensor_msgs::PointCloud2 cloud = floatCloud({"x", "y", "z"}, {0.F, 0.F, 0.F});
  cloud.fields[0].datatype = PointField::FLOAT64;
  cloud.fields[1].offset = 8;
  cloud.fields[1].datatype = PointField::INT16;
  cloud.fields[2].offset = 10;
  cloud.fields[2].datatype = PointField::UINT8;
  cloud.point_step = 11;
  cloud.height = 2;
  cloud.row_step = 16;
  cloud.data.assign(32, 0xEE);
  for (std::size_t row = 0; row < 2; ++row) {
    const double x = 1.5 + static_cast<double>(row);
    const std::int16_t y = -300;
    std::memcpy(&cloud.data[16 * row], &x, 8);
    std::memcpy(&cloud.data[16 * row + 8], &y, 2);
    cloud.data[16 * row + 10] = 200;
  }
  const std::vector<CloudPoint> points = pointsOf(cloud);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].position, Eigen::Vector3f(1.5F, -300.F, 200.F));
  EXPECT_EQ(points[1].position, Eigen::Vector3f(2.5F, -300.F, 200.F));
}

TEST(PointsOf, EmptyCloudsAreNormal) {
  EXPECT_TRUE(pointsOf({}).empty());
  EXPECT_TRUE(pointsOf(floatCloud({"x", "y", "z"}, {})).empty());
}

TEST(PointsOf, NeedsThreeCoordinates) {
  expectRefusal([] { pointsOf(floatCloud({"x", "y"}, {1.F, 2.F})); }, {"x, y;", "z"});
  expectRefusal([] { pointsOf(floatCloud({"range"}, {1.F})); }, {"range", "x, y and z"});
}

// The data are long enough for what would be read beyond the point: what is tested is the refusal.
TEST(PointsOf, RefusesFieldsThatDoNotFitIntoAPoint) {
  for (const char* name : {"x", "y", "z", "residual"}) {
    sensor_msgs::PointCloud2 cloud =
        floatCloud({"x", "y", "z", "residual"}, {1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F});
    cloud.width = 1;
    EXPECT_EQ(pointsOf(cloud).size(), 1U);
    for (sensor_msgs::PointField& field : cloud.fields)
      if (field.name == name) field.offset = 13;
    expectRefusal([&] { pointsOf(cloud); }, {name});
  }
}

TEST(PointsOf, RefusesFieldsOfNoKnownType) {
  for (const std::uint8_t type : {std::uint8_t{0}, std::uint8_t{9}}) {
    sensor_msgs::PointCloud2 cloud = floatCloud({"x", "y", "z"}, {1.F, 2.F, 3.F});
    cloud.fields[1].datatype = type;
    expectRefusal([&] { pointsOf(cloud); }, {"y"});
  }
}

}  // namespace
}  // namespace radar_dot
