// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// A car crosses before a vehicle with five radars: from raw clouds to objects, with all that can go wrong.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Log.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "live_graph.h"
#include "live_mask.h"
#include "nodelets/messages/object_arrays.h"
#include "object_scene.h"
#include "radar_dot/MovingObjects.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::PointCloud2;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

class MovingObjectsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    handle_ = std::make_unique<ros::NodeHandle>();
    scene_ = std::make_unique<ObjectScene>(*handle_);
    time_ = 0.0;
  }
  static void TearDownTestSuite() {
    scene_.reset();
    handle_.reset();
  }

  void SetUp() override {
    ASSERT_TRUE(waitUntil([this] {
      return objects_.connected() && in_base_.connected() && markers_.connected() && scene_->heard();
    }));
    scene_->before_scan = [](double) {};
    scene_->car.reset();
    drive(1.5);  // the nodelets find their audience, tracks of the test before end
  }

  void drive(double duration) {
    scene_->drive(time_, time_ + duration);
    time_ += duration;
    for (const auto* objects : {&objects_, &in_base_}) {
      EXPECT_TRUE(waitUntil([&] {
        const double age = objects->count() > 0 ? time_ - secondsOf(objects->latest()->header.stamp) : 1.0;
        return age >= 0.0 && age < 0.25;
      })) << "no objects of the latest sweeps";
    }
  }

  /// A car that crosses from the right, 35 m ahead.
  void addCar() {
    const Eigen::Isometry3d pose = scene_->world.poseAt(time_);
    Mover car;
    car.velocity = (pose.linear() * Eigen::Vector3d(3.0, 6.0, 0.0)).head<2>();
    car.start = (pose * Eigen::Vector3d(35.0, -12.0, 0.0)).head<2>() - time_ * car.velocity;
    scene_->car = car;
  }

  static double secondsOf(const ros::Time& stamp) { return stamp.toSec() - ObjectScene::kStart; }

  /// From `begin` (s) on there is the car and nothing else, with one id. @return the id
  std::uint64_t expectCar(const Recorder<MovingObjects>& recorder, double begin) const {
    std::set<std::uint64_t> ids;
    std::size_t count = 0;
    for (const MovingObjectsConstPtr& message : recorder.messages()) {
      const double seconds = secondsOf(message->header.stamp);
      if (seconds < begin || seconds > time_) continue;
      ++count;
      EXPECT_EQ(message->objects.size(), 1U) << seconds << " s";
      if (message->objects.size() != 1) continue;
      const MovingObject& object = message->objects[0];
      ids.insert(object.id);
      EXPECT_EQ(object.stamp, message->header.stamp);
      const Eigen::Isometry3d T_base_from_frame = poseIn(*message).inverse();
      const Eigen::Vector3d position =
          T_base_from_frame * Eigen::Vector3d(object.position.x, object.position.y, object.position.z);
      const Eigen::Vector3d velocity =
          T_base_from_frame.linear() * Eigen::Vector3d(object.velocity.x, object.velocity.y, 0.0);
      EXPECT_LT((position.head<2>() - scene_->carPosition(seconds)).norm(), 1.0) << seconds << " s";
      EXPECT_LT((velocity.head<2>() - scene_->carVelocity(seconds)).norm(), 0.5) << seconds << " s";
      EXPECT_GT(object.position_covariance[0], 0.0);
      EXPECT_GT(object.velocity_covariance[3], 0.0);
    }
    EXPECT_GT(static_cast<double>(count), 0.7 * 13.0 * (time_ - begin)) << "one message for each sweep";
    EXPECT_EQ(ids.size(), 1U);
    return ids.empty() ? 0 : *ids.begin();
  }

  /// Of the base, in the frame of the message.
  Eigen::Isometry3d poseIn(const MovingObjects& message) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (message.header.frame_id == "base_link") return pose;
    EXPECT_EQ(message.header.frame_id, "odom");
    const auto odometry = odometry_.messages();
    const auto found = std::find_if(odometry.begin(), odometry.end(), [&](const auto& candidate) {
      // Not what a test publishes there without a rotation.
      return candidate->header.stamp == message.header.stamp && candidate->pose.pose.orientation.w != 0.0;
    });
    if (found == odometry.end()) {
      ADD_FAILURE() << "no pose at " << message.header.stamp;
      return pose;
    }
    const auto& p = (*found)->pose.pose.position;
    const auto& q = (*found)->pose.pose.orientation;
    return Eigen::Translation3d(p.x, p.y, p.z) * Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  }

  std::vector<MovingObject> latestObjects() const {
    const auto messages = objects_.messages();
    if (!messages.empty()) return messages.back()->objects;
    ADD_FAILURE() << "no message of objects";
    return {};
  }

  std::set<std::string> namespacesOf(int action, std::int32_t id) const {
    std::set<std::string> names;
    for (const auto& array : markers_.messages())
      for (const Marker& marker : array->markers)
        if (marker.action == action && marker.id == id) names.insert(marker.ns);
    return names;
  }

  bool logged(const std::string& topic, const std::string& cause) const {
    const auto lines = log_.messages();
    return std::any_of(lines.begin(), lines.end(), [&](const rosgraph_msgs::LogConstPtr& line) {
      return line->msg.find("moving_objects") != std::string::npos &&
             line->msg.find(topic) != std::string::npos && line->msg.find(cause) != std::string::npos;
    });
  }

  static inline std::unique_ptr<ros::NodeHandle> handle_;
  static inline std::unique_ptr<ObjectScene> scene_;
  static inline double time_ = 0.0;  // s since the beginning of the scene

  Recorder<MovingObjects> objects_{*handle_, "dynamic/objects"}, in_base_{*handle_, "in_base/objects"},
      misspelt_{*handle_, "misspelt/objects"};
  Recorder<MarkerArray> markers_{*handle_, "dynamic/markers"};
  Recorder<nav_msgs::Odometry> odometry_{*handle_, "odom"};
  Recorder<rosgraph_msgs::Log> log_{*handle_, "/rosout"};
  Diagnostics diagnostics_{*handle_};
};

TEST_F(MovingObjectsTest, ACrossingCarHasItsPositionAndVelocityAndOneId) {
  addCar();
  const double begin = time_;
  drive(3.5);
  const std::uint64_t id = expectCar(objects_, begin + 1.0);
  expectCar(in_base_, begin + 1.0);
  const auto last = latestObjects();
  ASSERT_EQ(last.size(), 1U);
  EXPECT_NEAR(secondsOf(last[0].first_seen), begin, 0.3);
  EXPECT_GT(last[0].detections, 50U);
  EXPECT_GE(last[0].return_count, 1U);
  EXPECT_EQ(last[0].box_width, 0U) << "there was no image";

  // Markers of the car, and their end with its own.
  const auto marker_id = static_cast<std::int32_t>(id);
  const std::set<std::string> all = {"objects", "velocities", "labels"};
  EXPECT_EQ(namespacesOf(Marker::ADD, marker_id), all);
  EXPECT_TRUE(namespacesOf(Marker::DELETE, marker_id).empty());
  scene_->car.reset();
  drive(1.5);
  EXPECT_TRUE(latestObjects().empty());
  EXPECT_EQ(namespacesOf(Marker::DELETE, marker_id), all);
  EXPECT_TRUE(
      waitUntil([this] { return diagnostics_.seen("moving_objects: objects", DiagnosticStatus::OK); }));
}

// In the frames that their users expect: planners do not turn velocities.
TEST_F(MovingObjectsTest, OthersGetTheCarInTheirOwnMessages) {
  using derived_object_msgs::ObjectWithCovarianceArray;
  const Recorder<ObjectWithCovarianceArray> arrays(*handle_, "in_base/objects_with_covariance");
  const Recorder<costmap_converter::ObstacleArrayMsg> obstacles(*handle_, "in_base/obstacles");
  ASSERT_TRUE(waitUntil([&] { return arrays.connected() && obstacles.connected(); }));
  addCar();
  drive(2.5);
  ASSERT_TRUE(arrays.count() > 13 && obstacles.count() > 13) << "one for each sweep";
  const auto array = arrays.latest();
  double seconds = secondsOf(array->header.stamp);
  EXPECT_EQ(array->header.frame_id, "base_link");
  ASSERT_EQ(array->objects.size(), 1U);
  const auto& object = array->objects[0];
  const Eigen::Vector2d velocity(object.twist.twist.linear.x, object.twist.twist.linear.y);
  EXPECT_LT((Eigen::Vector2d(object.pose.pose.position.x, object.pose.pose.position.y) -
             scene_->carPosition(seconds))
                .norm(),
            1.0);
  EXPECT_LT((velocity - scene_->carVelocity(seconds)).norm(), 0.5);
  EXPECT_EQ(object.id, latestObjects().at(0).id);

  MovingObjects frame;  // of the obstacles
  frame.header = obstacles.latest()->header;
  EXPECT_EQ(frame.header.frame_id, "odom");
  seconds = secondsOf(frame.header.stamp);
  ASSERT_EQ(obstacles.latest()->obstacles.size(), 1U);
  const auto& obstacle = obstacles.latest()->obstacles[0];
  const auto& centre = obstacle.polygon.points.at(0);
  const auto& linear = obstacle.velocities.twist.linear;
  const Eigen::Isometry3d T_base_from_odom = poseIn(frame).inverse();
  EXPECT_LT(
      ((T_base_from_odom * Eigen::Vector3d(centre.x, centre.y, 0.0)).head<2>() - scene_->carPosition(seconds))
          .norm(),
      1.0);
  EXPECT_LT(((T_base_from_odom.linear() * Eigen::Vector3d(linear.x, linear.y, 0.0)).head<2>() -
             scene_->carVelocity(seconds))
                .norm(),
            0.5);
  scene_->car.reset();
  drive(1.5);
  EXPECT_TRUE(arrays.latest()->objects.empty());
  EXPECT_TRUE(obstacles.latest()->obstacles.empty()) << "an old one must not stay";
}

TEST_F(MovingObjectsTest, WhatStandsIsNoObject) {
  const double begin = time_;
  drive(2.0);
  std::size_t messages = 0;
  for (const MovingObjectsConstPtr& message : objects_.messages()) {
    if (secondsOf(message->header.stamp) < begin) continue;
    ++messages;
    EXPECT_TRUE(message->objects.empty());
  }
  EXPECT_GT(messages, 18U) << "a message for each sweep, also without objects";
}

/// One labelled return.
PointCloud2 goodCloud(double seconds) {
  PointCloud2 cloud = cloudOf(ObjectScene::stampAt(seconds), "radar_front", {{20.F, 0.F, 0.F}});
  sensor_msgs::PointField field = cloud.fields.back();
  field.name = "residual";
  field.offset = cloud.point_step;
  cloud.fields.push_back(field);
  cloud.point_step += 4;
  cloud.row_step = cloud.point_step;
  cloud.data.resize(cloud.point_step);
  return cloud;
}

TEST_F(MovingObjectsTest, BadMessagesAreNamedAndHarmNobody) {
  ros::Publisher clouds = handle_->advertise<PointCloud2>("radar/dynamic", 10);
  ros::Publisher twists = handle_->advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10);
  ros::Publisher poses = handle_->advertise<nav_msgs::Odometry>("odom", 10);
  ASSERT_TRUE(waitUntil([&] { return clouds.getNumSubscribers() + poses.getNumSubscribers() > 2; }));
  const auto send = [&](int kind, double seconds) {
    PointCloud2 cloud = goodCloud(seconds);
    nav_msgs::Odometry pose;
    pose.header.stamp = ObjectScene::stampAt(seconds);
    pose.header.frame_id = "odom";
    pose.child_frame_id = kind == 8 ? "trailer" : "base_link";
    geometry_msgs::TwistWithCovarianceStamped twist;
    twist.header.stamp = pose.header.stamp;
    twist.header.frame_id = "nowhere";
    switch (kind) {
      case 0: cloud.fields.pop_back(); break;
      case 1: cloud.data.pop_back(); break;
      case 2: cloud.header.frame_id.clear(); break;
      case 3: cloud.header.stamp = ros::Time(); break;
      case 4: cloud.header.stamp += ros::Duration(100.0); break;
      case 5: cloud.header.stamp -= ros::Duration(1.0); break;
      case 6: cloud.header.frame_id = "no_such_frame"; break;
      case 7: cloud.fields[0].offset = 4'000'000'000U; break;
      case 8:
      case 9: return poses.publish(pose);  // no quaternion
      default: return twists.publish(twist);
    }
    clouds.publish(cloud);
  };
  addCar();
  const double begin = time_;
  int next = 0;
  scene_->before_scan = [&](double seconds) {
    // Not before the car is followed: one after the other, every fifth of a second.
    if (seconds > begin + 1.0 + 0.2 * next) send(next++ % 11, seconds);
  };
  drive(3.8);
  EXPECT_GT(next, 11);
  expectCar(objects_, begin + 1.0);
  expectCar(in_base_, begin + 1.0);
  const std::string cloud_topic = "'/radar/dynamic'";
  EXPECT_TRUE(logged(cloud_topic, "residual"));
  EXPECT_TRUE(logged(cloud_topic, "bytes of data"));
  EXPECT_TRUE(logged(cloud_topic, "frame_id is empty"));
  EXPECT_TRUE(logged(cloud_topic, "stamp is zero"));
  EXPECT_TRUE(logged(cloud_topic, "ahead of the clock"));
  EXPECT_TRUE(logged(cloud_topic, "already used"));
  EXPECT_TRUE(logged("no_such_frame", "left out"));
  EXPECT_TRUE(logged(cloud_topic, "does not fit"));
  EXPECT_TRUE(logged("'/odom'", "child_frame_id"));
  EXPECT_TRUE(logged("'/odom'", "quaternion"));
  EXPECT_TRUE(logged("'/ego/twist'", "nowhere"));
  EXPECT_TRUE(diagnostics_.seen("moving_objects: input radar/dynamic", DiagnosticStatus::WARN));
}

TEST_F(MovingObjectsTest, BadParametersHaveTheirDefaultsAndAreReported) {
  addCar();
  const double begin = time_;
  drive(2.5);
  expectCar(misspelt_, begin + 1.0);
  const std::string message = diagnostics_.latest("misspelt: objects").message;
  EXPECT_TRUE(diagnostics_.seen("misspelt: objects", DiagnosticStatus::ERROR));
  EXPECT_NE(message.find("frame is 'moon', must be one of odom, base"), std::string::npos) << message;
  EXPECT_NE(message.find("gate is nan"), std::string::npos) << message;
}

TEST_F(MovingObjectsTest, WhenTimeGoesBackAllIsReset) {
  addCar();
  double begin = time_;
  drive(2.0);
  const std::uint64_t before = expectCar(objects_, begin + 1.0);
  const std::size_t arrays = markers_.count();
  time_ = 0.0;
  addCar();
  begin = time_;
  drive(2.5);
  const std::uint64_t after = expectCar(objects_, begin + 1.0);
  EXPECT_GT(after, before) << "ids are never used again";
  const auto messages = markers_.messages();
  EXPECT_TRUE(std::any_of(
      messages.begin() + static_cast<std::ptrdiff_t>(arrays), messages.end(), [](const auto& array) {
        return array->markers.size() == 1 && array->markers[0].action == Marker::DELETEALL;
      }));
  const auto lines = log_.messages();  // one of the nodelets of the process says it for all
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const rosgraph_msgs::LogConstPtr& line) {
    return line->msg.find("resetting") != std::string::npos;
  }));
}

TEST_F(MovingObjectsTest, RegionsOfMasksTellWhereObjectsAreInTheImage) {
  LiveMask mask(*handle_);
  EXPECT_FALSE(reconfigure("moving_objects", {{"use_mask", true}}).empty());
  EXPECT_TRUE(waitUntil([&] { return mask.heard(); })) << "masks have no subscriber";
  double next = time_;
  const auto sendEveryTenth = [&](double seconds) {
    if (seconds < next) return;
    next += 0.1;
    mask.send(seconds, scene_->carPosition(seconds), scene_->carVelocity(seconds));
  };
  addCar();
  const Mover car = *scene_->car;
  scene_->before_scan = sendEveryTenth;
  const double begin = time_;
  drive(2.5);
  expectCar(objects_, begin + 1.0);
  const auto objects = latestObjects();
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_NEAR(objects[0].box_x, mask.box.x, 12.0) << "the latest mask, or the one before";
  EXPECT_NEAR(objects[0].box_y, mask.box.y, 2.0);
  EXPECT_EQ(objects[0].box_width, static_cast<std::uint32_t>(LiveMask::kWidth));
  EXPECT_EQ(objects[0].box_height, static_cast<std::uint32_t>(LiveMask::kHeight));
  EXPECT_EQ(objects[0].pixel_count, static_cast<std::uint32_t>(LiveMask::kWidth * LiveMask::kHeight));
  EXPECT_NEAR(objects[0].image_stamp.toSec(), mask.last.toSec(), 0.15);

  // The radars lose the car. Masks alone carry its track on for a while, but start none unless they may.
  const auto only_mask = [&](double seconds) {
    if (seconds < next) return;
    next += 0.1;
    const Eigen::Vector2d in_base = (scene_->world.poseAt(seconds).inverse() *
                                     Eigen::Vector3d(car.at(seconds).x(), car.at(seconds).y(), 0.0))
                                        .head<2>();
    mask.send(seconds, in_base, Eigen::Rotation2Dd(-scene_->world.yaw_rate * seconds) * car.velocity);
  };
  scene_->car.reset();
  scene_->before_scan = only_mask;
  drive(1.3);
  EXPECT_TRUE(latestObjects().empty());
  EXPECT_FALSE(reconfigure("moving_objects", {{"mask_starts_tracks", true}}).empty());
  drive(0.7);
  const auto alone = latestObjects();
  EXPECT_EQ(alone.size(), 1U);
  if (!alone.empty()) {
    EXPECT_EQ(alone[0].return_count, 0U);
  }
  EXPECT_FALSE(reconfigure("moving_objects", {{"mask_starts_tracks", false}}).empty());
  EXPECT_FALSE(reconfigure("moving_objects", {{"use_mask", false}}).empty());
  EXPECT_TRUE(waitUntil([&] { return !mask.heard(); }));
}

}  // namespace
}  // namespace radar_dot::test
