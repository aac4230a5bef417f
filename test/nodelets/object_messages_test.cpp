// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/object_messages.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "fixtures/definition_sum.h"

namespace radar_dot {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kTime = 1000.0;  // s

ObjectTrack exampleTrack() {
  ObjectTrack track;
  track.id = 5'000'000'007;
  track.time = kTime;
  track.birth = 990.5;
  track.last_hit = 999.75;
  track.hits = 42;
  track.return_count = 3;
  track.state << 3.0, 4.0, 1.0, 2.0;
  track.covariance << 4.0, 1.0, 0.0, 0.0,  //
      1.0, 9.0, 0.0, 0.0,                  //
      0.0, 0.0, 0.5, 0.25,                 //
      0.0, 0.0, 0.25, 0.75;
  return track;
}

MovingObjects objectsOf(const std::vector<std::uint64_t>& ids) {
  MovingObjects objects;
  objects.header.frame_id = "odom";
  objects.header.stamp = ros::Time(kTime);
  for (const std::uint64_t id : ids) {
    MovingObject& object = objects.objects.emplace_back();
    object.id = id;
    object.position.x = 10.0;
    object.position.y = -2.0;
    object.position.z = 0.5;
    object.velocity.x = 3.0;
    object.velocity.y = -4.0;
  }
  return objects;
}

std::set<std::pair<std::string, int>> keysOf(const MarkerArray& array, int action) {
  std::set<std::pair<std::string, int>> keys;
  for (const Marker& marker : array.markers)
    if (marker.action == action) keys.insert({marker.ns, marker.id});
  return keys;
}

/// Covariances row by row.
void expectState(const MovingObject& object, const Eigen::Vector3d& position, const Eigen::Vector2d& velocity,
                 const std::array<double, 4>& position_covariance,
                 const std::array<double, 4>& velocity_covariance) {
  EXPECT_NEAR(object.position.x, position.x(), 1e-12);
  EXPECT_NEAR(object.position.y, position.y(), 1e-12);
  EXPECT_EQ(object.position.z, position.z());
  EXPECT_NEAR(object.velocity.x, velocity.x(), 1e-12);
  EXPECT_NEAR(object.velocity.y, velocity.y(), 1e-12);
  EXPECT_EQ(object.velocity.z, 0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(object.position_covariance[i], position_covariance[i], 1e-12) << i;
    EXPECT_NEAR(object.velocity_covariance[i], velocity_covariance[i], 1e-12) << i;
  }
}

TEST(ObjectMessage, InTheFrameOfTheOdometryTheStateIsAsItIs) {
  FrameOfObjects frame;
  frame.height = 0.75;
  const MovingObject object = objectMessage(exampleTrack(), ros::Time(kTime), frame, 1.0);
  EXPECT_EQ(object.id, 5'000'000'007U);
  EXPECT_EQ(object.stamp, ros::Time(kTime));
  expectState(object, {3.0, 4.0, 0.75}, {1.0, 2.0}, {4.0, 1.0, 1.0, 9.0}, {0.5, 0.25, 0.25, 0.75});
  EXPECT_EQ(object.first_seen, ros::Time(990.5));
  EXPECT_EQ(object.last_seen, ros::Time(999.75));
  EXPECT_EQ(object.detections, 42U);
  EXPECT_EQ(object.return_count, 3U);
}

// A quarter turn swaps the axes of the covariance and turns the sign of what they share.
TEST(ObjectMessage, AnotherFrameTurnsPositionVelocityAndCovariances) {
  FrameOfObjects frame;
  frame.T_frame_from_odom.linear() = Eigen::Rotation2Dd(std::acos(-1.0) / 2.0).toRotationMatrix();
  frame.T_frame_from_odom.translation() = Eigen::Vector2d(10.0, 20.0);
  const MovingObject object = objectMessage(exampleTrack(), ros::Time(kTime), frame, 1.0);
  expectState(object, {6.0, 23.0, 0.0}, {-2.0, 1.0}, {9.0, -1.0, -1.0, 4.0}, {0.75, -0.25, -0.25, 0.5});
}

TEST(ObjectMessage, ABoxIsToldAsLongAsItsImageIsYoungEnough) {
  ObjectTrack track = exampleTrack();
  track.box = {640, 300, 120, 80};
  track.pixel_count = 5000;
  track.last_image = kTime - 0.5;
  const MovingObject seen = objectMessage(track, ros::Time(kTime), {}, 0.6);
  EXPECT_EQ(seen.box_x, 640U);
  EXPECT_EQ(seen.box_y, 300U);
  EXPECT_EQ(seen.box_width, 120U);
  EXPECT_EQ(seen.box_height, 80U);
  EXPECT_EQ(seen.pixel_count, 5000U);
  EXPECT_EQ(seen.image_stamp, ros::Time(kTime - 0.5));
  const MovingObject old = objectMessage(track, ros::Time(kTime), {}, 0.4);
  EXPECT_EQ(old.box_width, 0U);
  EXPECT_EQ(old.pixel_count, 0U);
  EXPECT_TRUE(old.image_stamp.isZero());
  EXPECT_TRUE(objectMessage(exampleTrack(), ros::Time(kTime), {}, 1e9).image_stamp.isZero());
}

TEST(PlanarPose, KeepsPositionAndHeadingOfATiltedPose) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  const Eigen::Isometry2d planar = planarPose(pose);
  EXPECT_NEAR(Eigen::Rotation2Dd(planar.linear()).angle(), 0.7, 1e-12);
  EXPECT_EQ(planar.translation(), Eigen::Vector2d(1.0, 2.0));
}

template <typename Message>
void expectSoundDefinition() {
  EXPECT_EQ(test::sumOfDefinition<Message>(), ros::message_traits::md5sum<Message>());
}

// The sums are those of the released packages.
TEST(ForeignObjects, SumsAreThoseOfTheDefinitions) {
  expectSoundDefinition<geometry_msgs::TwistWithCovariance>();
  expectSoundDefinition<derived_object_msgs::ObjectWithCovarianceArray>();
  expectSoundDefinition<costmap_converter::ObstacleArrayMsg>();
}

/// At (10, -2, 0.5) with (3, -4) m/s; of the covariance of the velocity (1, 0.5; 0.5, 2) the part across it
/// is (4, 3)/5, which makes (16 + 12 + 18)/25 = 1.84.
MovingObjects oneObject() {
  MovingObjects objects = objectsOf({5'000'000'007});
  objects.objects[0].position_covariance = {4.0, 1.0, 1.0, 9.0};
  objects.objects[0].velocity_covariance = {1.0, 0.5, 0.5, 2.0};
  return objects;
}

void expectCovariance(const boost::array<double, 36>& covariance, const std::array<double, 4>& planar,
                      double last) {
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double expected = i < 2 && k < 2 ? planar[2 * i + k] : i != k ? 0.0 : i == 5 ? last : 1e6;
      EXPECT_NEAR(covariance[6 * i + k], expected, 1e-12) << i << ' ' << k;
    }
  }
}

TEST(ForeignObjects, WithCovarianceHaveTheStateAndSayWhatIsNotKnown) {
  const auto array = objectsWithCovariance(oneObject());
  EXPECT_EQ(array.header.frame_id, "odom");
  ASSERT_EQ(array.objects.size(), 1U);
  const auto& object = array.objects[0];
  EXPECT_EQ(object.header.frame_id, "odom");
  EXPECT_EQ(object.header.stamp, ros::Time(kTime));
  EXPECT_EQ(object.id, 5'000'000'007U % 4'294'967'296U);
  EXPECT_EQ(object.detection_level, 1) << "tracked";
  EXPECT_EQ(object.object_classified, 0);
  EXPECT_EQ(object.classification, 0);
  EXPECT_EQ(object.pose.pose.position.x, 10.0);
  EXPECT_EQ(object.pose.pose.position.y, -2.0);
  EXPECT_EQ(object.pose.pose.position.z, 0.5);
  // Half of the angle of (3, -4): the bisector of that and (1, 0) is (2, -1).
  EXPECT_NEAR(object.pose.pose.orientation.w, 2.0 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(object.pose.pose.orientation.z, -1.0 / std::sqrt(5.0), 1e-12);
  expectCovariance(object.pose.covariance, {4.0, 1.0, 1.0, 9.0}, 1.84 / 25.0);
  EXPECT_EQ(object.twist.twist.linear.x, 3.0);
  EXPECT_EQ(object.twist.twist.linear.y, -4.0);
  expectCovariance(object.twist.covariance, {1.0, 0.5, 0.5, 2.0}, 1e6);
  expectCovariance(object.accel.covariance, {1e6, 0.0, 0.0, 1e6}, 1e6);
  EXPECT_TRUE(object.polygon.points.empty());
  EXPECT_EQ(object.shape.type, 3) << "a cylinder";
  EXPECT_EQ(object.shape.dimensions.size(), 2U);
}

TEST(ForeignObjects, AHeadingIsAtMostUnknown) {
  MovingObjects objects = oneObject();
  objects.objects[0].velocity.x = objects.objects[0].velocity.y = 0.0;
  EXPECT_NEAR(objectsWithCovariance(objects).objects[0].pose.covariance[35], M_PI * M_PI / 3.0, 1e-12);
}

TEST(ForeignObjects, ObstaclesAreDiscsThatMove) {
  const auto array = obstaclesOf(oneObject());
  EXPECT_EQ(array.header.stamp, ros::Time(kTime));
  ASSERT_EQ(array.obstacles.size(), 1U);
  const auto& obstacle = array.obstacles[0];
  EXPECT_EQ(obstacle.header.frame_id, "odom");
  EXPECT_EQ(obstacle.id, 5'000'000'007);
  ASSERT_EQ(obstacle.polygon.points.size(), 1U);
  EXPECT_EQ(obstacle.polygon.points[0].x, 10.F);
  EXPECT_EQ(obstacle.polygon.points[0].y, -2.F);
  EXPECT_EQ(obstacle.radius, 1.0) << "that of the markers";
  EXPECT_EQ(obstacle.velocities.twist.linear.x, 3.0);
  EXPECT_EQ(obstacle.velocities.twist.linear.y, -4.0);
  expectCovariance(obstacle.velocities.covariance, {1.0, 0.5, 0.5, 2.0}, 1e6);
  EXPECT_NEAR(obstacle.orientation.w, 2.0 / std::sqrt(5.0), 1e-12);
  EXPECT_TRUE(obstaclesOf(objectsOf({})).obstacles.empty());
}

TEST(ObjectMarkers, EachObjectHasABodyAnArrowOfOneSecondAndALabel) {
  ObjectMarkers markers;
  const MarkerArray array = markers.update(objectsOf({7}), 0.5);
  ASSERT_EQ(array.markers.size(), 3U);
  for (const Marker& marker : array.markers) {
    EXPECT_EQ(marker.header.frame_id, "odom");
    EXPECT_EQ(marker.header.stamp, ros::Time(kTime));
    EXPECT_EQ(marker.id, 7);
    EXPECT_EQ(marker.lifetime, ros::Duration(0.5));
    EXPECT_GT(marker.color.a, 0.F);
  }
  EXPECT_EQ(array.markers[0].type, Marker::CYLINDER);
  EXPECT_EQ(array.markers[0].pose.position.x, 10.0);
  EXPECT_EQ(array.markers[1].type, Marker::ARROW);
  ASSERT_EQ(array.markers[1].points.size(), 2U);
  EXPECT_EQ(array.markers[1].points[0].x, 10.0);
  EXPECT_EQ(array.markers[1].points[1].x, 13.0);
  EXPECT_EQ(array.markers[1].points[1].y, -6.0);
  EXPECT_EQ(array.markers[2].type, Marker::TEXT_VIEW_FACING);
  EXPECT_EQ(array.markers[2].text, "7: 5.0 m/s");
}

TEST(ObjectMarkers, WhatHasEndedIsDeletedOnce) {
  ObjectMarkers markers;
  markers.update(objectsOf({7, 8}), 0.5);
  const MarkerArray next = markers.update(objectsOf({8}), 0.5);
  EXPECT_EQ(keysOf(next, Marker::DELETE),
            (std::set<std::pair<std::string, int>>{{"objects", 7}, {"velocities", 7}, {"labels", 7}}));
  EXPECT_EQ(keysOf(next, Marker::ADD).count({"objects", 8}), 1U);
  EXPECT_TRUE(keysOf(markers.update(objectsOf({8}), 0.5), Marker::DELETE).empty());
}

TEST(ObjectMarkers, DeletesAllAndForgetsThem) {
  ObjectMarkers markers;
  MovingObjects objects = objectsOf({7});
  markers.update(objects, 0.5);
  const MarkerArray all = markers.deleteAll(objects.header);
  ASSERT_EQ(all.markers.size(), 1U);
  EXPECT_EQ(all.markers[0].action, Marker::DELETEALL);
  EXPECT_EQ(all.markers[0].header.frame_id, "odom");
  EXPECT_TRUE(markers.update(objectsOf({}), 0.5).markers.empty()) << "nothing is on show any more";
}

TEST(ObjectMarkers, LargeIdsStayPositive) {
  ObjectMarkers markers;
  for (const Marker& marker : markers.update(objectsOf({0xFFFF'FFFF'FFFFU}), 0.5).markers)
    EXPECT_GT(marker.id, 0);
}

}  // namespace
}  // namespace radar_dot
