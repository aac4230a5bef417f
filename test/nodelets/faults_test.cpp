// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Five live radars, some of which fail in every known way; the others must not suffer.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "live_radars.h"
#include "radar_dot/EgoStatus.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using geometry_msgs::TwistWithCovarianceStamped;
using sensor_msgs::PointCloud2;

constexpr LiveRadars::Radar kFront = LiveRadars::kFront, kFrontLeft = LiveRadars::kFrontLeft,
                            kFrontRight = LiveRadars::kFrontRight, kBackLeft = LiveRadars::kBackLeft,
                            kBackRight = LiveRadars::kBackRight;
using Fault = LiveRadars::Fault;

// Stamps that no difference of ros::Time survives.
const ros::Time kLastStamp(4'294'967'000U, 0);

// Changes a float32 field of all points, which need not be aligned.
void edit(PointCloud2& cloud, const char* field, const std::function<float(float)>& change) {
  const std::size_t offset = offsetOf(cloud, field);
  for (std::size_t start = 0; start < cloud.data.size(); start += cloud.point_step) {
    float value = 0.F;
    std::memcpy(&value, &cloud.data[start + offset], sizeof value);
    value = change(value);
    std::memcpy(&cloud.data[start + offset], &value, sizeof value);
  }
}

// Publishes the rotation of the steady turn at 50 Hz, as an IMU and as an odometry.
class LiveRotation {
 public:
  explicit LiveRotation(ros::NodeHandle& handle)
      : imu_(handle.advertise<sensor_msgs::Imu>("test/imu", 10)),
        odometry_(handle.advertise<nav_msgs::Odometry>("test/odom", 10)) {}
  void publish(const ros::Time& stamp) const {
    sensor_msgs::Imu imu;
    imu.header.stamp = stamp;
    imu.header.frame_id = "base_link";
    imu.angular_velocity.z = LiveRadars::kYawRate * gyro_factor;
    imu_.publish(imu);
    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = "map";
    odometry.child_frame_id = "base_link";
    const double yaw = LiveRadars::kYawRate * (stamp.toSec() - start_.toSec());
    odometry.pose.pose.orientation.w = std::cos(0.5 * yaw);
    odometry.pose.pose.orientation.z = std::sin(0.5 * yaw);
    const double radius = speed / LiveRadars::kYawRate;
    odometry.pose.pose.position.x = radius * std::sin(yaw);
    odometry.pose.pose.position.y = radius * (1.0 - std::cos(yaw));
    odometry_.publish(odometry);
  }
  /// Between the steady ones; NaN and such in every number.
  void publishBroken(double value, std::size_t field) const {
    sensor_msgs::Imu imu;
    nav_msgs::Odometry odometry;
    imu.header.stamp = odometry.header.stamp = ros::Time::now();
    imu.header.frame_id = odometry.child_frame_id = "base_link";
    odometry.header.frame_id = "map";
    odometry.pose.pose.orientation.w = 1.0;
    const std::vector<double*> numbers = {&imu.angular_velocity.x,
                                          &imu.angular_velocity.z,
                                          &imu.angular_velocity_covariance[0],
                                          &imu.angular_velocity_covariance[8],
                                          &imu.linear_acceleration.x,
                                          &imu.linear_acceleration.z,
                                          &odometry.pose.pose.position.x,
                                          &odometry.pose.pose.orientation.z};
    *numbers[field % numbers.size()] = value;
    imu_.publish(imu);
    odometry_.publish(odometry);
  }
  std::atomic<double> gyro_factor{1.0}, speed{LiveRadars::kSpeed};

 private:
  const ros::Time start_ = ros::Time::now();
  const ros::Publisher imu_, odometry_;
  const Ticker ticker_{50.0, [this] { publish(ros::Time::now()); }};
};

class FaultsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(statuses_.grows(1));
    ASSERT_TRUE(twists_.grows(6)) << "no twist from healthy radars";
  }

  // Twists go on, and every one of the next is the truth.
  void expectTwistsGoOn() {
    const std::size_t before = twists_.count();
    EXPECT_TRUE(twists_.grows(8));
    const auto twists = twists_.messages();
    for (std::size_t i = before; i < twists.size(); ++i) {
      EXPECT_NEAR(twists[i]->twist.twist.linear.x, 8.0, 0.05);
      EXPECT_NEAR(twists[i]->twist.twist.linear.y, 0.0, 0.05);
      EXPECT_NEAR(twists[i]->twist.twist.angular.z, 0.1, 0.03);
    }
  }

  ros::NodeHandle handle_;
  Recorder<TwistWithCovarianceStamped> twists_{handle_, "ego/twist"};
  Recorder<EgoStatus> statuses_{handle_, "ego/status"};
  Recorder<PointCloud2> still_{handle_, "radar/static"};
  Recorder<nav_msgs::Odometry> odometry_{handle_, "odom"};
  Diagnostics diagnostics_{handle_};
  LiveRadars radars_{handle_};
};

TEST_F(FaultsTest, SilentRadarIsNamedAndTheOthersGoOn) {
  expectTwistsGoOn();
  radars_.silence(kFrontLeft);
  expectTwistsGoOn();
  EXPECT_TRUE(diagnostics_.says("ego_velocity: radar front_left", DiagnosticStatus::ERROR, "silent"));
  EXPECT_TRUE(diagnostics_.says("ego_velocity: radar front", DiagnosticStatus::OK, "Hz"));
  EXPECT_TRUE(waitUntil([this] { return statuses_.latest()->radar_count == 4; }));
  radars_.set(kFrontLeft, {});
  EXPECT_TRUE(waitUntil([this] { return statuses_.latest()->radar_count == 5; }));
  EXPECT_TRUE(diagnostics_.says("ego_velocity: radar front_left", DiagnosticStatus::OK, "Hz"));
}

TEST_F(FaultsTest, BadCloudsAreRefusedWithTheirCause) {
  struct Kind {
    std::string cause;
    Fault fault;
    int level = DiagnosticStatus::ERROR;
  };
  const std::vector<Kind> kinds = {
      {"'vx'", [](PointCloud2& c) { c.fields.erase(c.fields.begin() + 6); }},
      {"bytes of data", [](PointCloud2& c) { c.data.resize(c.data.size() / 2); }},
      {"point_step", [](PointCloud2& c) { c.point_step = 0; }},
      {"frame_id", [](PointCloud2& c) { c.header.frame_id.clear(); }},
      {"byte order", [](PointCloud2& c) { c.is_bigendian = 1; }},
      {"stamp is zero", [](PointCloud2& c) { c.header.stamp = ros::Time(); }},
      {"ahead of the clock", [](PointCloud2& c) { c.header.stamp += ros::Duration(3600.0); }},
      {"ahead of the clock", [](PointCloud2& c) { c.header.stamp = kLastStamp; }},
      {"stamp not newer", [](PointCloud2& c) { c.header.stamp = ros::Time(5.0); }},
      {"outside the window", [](PointCloud2& c) { c.header.stamp -= ros::Duration(0.3); },
       DiagnosticStatus::WARN},
      {"does not fit", [](PointCloud2& c) { c.fields[0].offset = 4'000'000'000U; }},
      {"no transform from 'nowhere' to 'base_link'", [](PointCloud2& c) { c.header.frame_id = "nowhere"; }},
  };
  const std::vector<std::pair<LiveRadars::Radar, std::string>> victims = {
      {kFrontLeft, "front_left"}, {kFrontRight, "front_right"}, {kBackLeft, "back_left"}};
  for (std::size_t first = 0; first < kinds.size(); first += victims.size()) {
    for (std::size_t i = 0; i < victims.size(); ++i) radars_.set(victims[i].first, kinds.at(first + i).fault);
    expectTwistsGoOn();
    for (std::size_t i = 0; i < victims.size(); ++i) {
      const std::string name = "ego_velocity: radar " + victims[i].second;
      EXPECT_TRUE(diagnostics_.says(name, kinds[first + i].level, kinds[first + i].cause));
    }
  }
}

TEST_F(FaultsTest, EmptyCloudsAndNothingButNaNAreHarmless) {
  radars_.set(kFrontLeft, [](PointCloud2& cloud) {
    cloud.width = cloud.row_step = 0;
    cloud.data.clear();
  });
  radars_.set(kBackRight, [](PointCloud2& cloud) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < cloud.width; ++i)
      std::memcpy(&cloud.data[i * cloud.point_step], &nan, sizeof nan);
  });
  expectTwistsGoOn();
  EXPECT_TRUE(diagnostics_.says("ego_velocity: radar front_left", DiagnosticStatus::OK, "Hz"));
  EXPECT_TRUE(waitUntil([this] {
    const auto values = diagnostics_.latest("ego_velocity: radar back_right").values;
    return values.count("returns not finite") == 1 && values.at("returns not finite") == "45";
  })) << "45 of 50 returns pass the other filters";
}

TEST_F(FaultsTest, RefusedEstimateGivesAStatusAndNothingElse) {
  radars_.setAll([](PointCloud2& cloud) {
    cloud.width = 1;
    cloud.row_step = cloud.point_step;
    cloud.data.resize(cloud.row_step);
  });
  ASSERT_TRUE(waitUntil([this] { return statuses_.latest()->status == EgoStatus::TOO_FEW_RETURNS; }));
  ASSERT_TRUE(statuses_.grows(2));  // no healthy scan is under way any more
  const ros::Time refused = statuses_.latest()->header.stamp;
  ASSERT_TRUE(statuses_.grows(6));
  EXPECT_LT(twists_.latest()->header.stamp, refused);
  EXPECT_LT(still_.latest()->header.stamp, refused);
  EXPECT_EQ(statuses_.latest()->status, EgoStatus::TOO_FEW_RETURNS);
  EXPECT_FALSE(statuses_.latest()->reason.empty());
  EXPECT_TRUE(diagnostics_.says("ego_velocity: estimator", DiagnosticStatus::ERROR, "refused"));
  // The odometry does not integrate over the gap that this makes.
  ASSERT_TRUE(waitUntil([this] {
    return (statuses_.latest()->header.stamp - odometry_.latest()->header.stamp).toSec() >
           0.5;  // above max_gap
  }));
  const auto poses = odometry_.messages();
  const auto at_gap = poses.back();
  radars_.setAll({});
  ASSERT_TRUE(odometry_.grows(1));
  const auto after_gap = odometry_.messages().at(poses.size());
  EXPECT_GT((after_gap->header.stamp - at_gap->header.stamp).toSec(), 0.5);
  EXPECT_LT(std::hypot(after_gap->pose.pose.position.x - at_gap->pose.pose.position.x,
                       after_gap->pose.pose.position.y - at_gap->pose.pose.position.y),
            0.1);
  EXPECT_GT(after_gap->pose.covariance[0], at_gap->pose.covariance[0] + 1.0) << "the gap makes it uncertain";
}

TEST_F(FaultsTest, ThresholdChangesLiveAndInvalidValuesAreRejected) {
  const auto dynamicCount = [this] { return statuses_.latest()->dynamic_count; };
  EXPECT_TRUE(waitUntil([&] { return dynamicCount() == 45; })) << dynamicCount();
  const auto change = [](double isolated, double supported, const char* invalid_states) {
    return reconfigure("ego_velocity", {{"isolated_threshold", isolated},
                                        {"supported_threshold", supported},
                                        {"invalid_states", invalid_states}});
  };

  // Moving returns have residuals of 3 to 12 m/s: above 18 m/s nothing is dynamic.
  EXPECT_EQ(change(18.0, 18.0, "0").at("invalid_states"), "0");
  EXPECT_TRUE(waitUntil([&] { return dynamicCount() == 0; })) << dynamicCount();
  EXPECT_TRUE(change(1.2, 0.6, "nine").empty()) << "rejected";
  ASSERT_TRUE(statuses_.grows());
  EXPECT_EQ(dynamicCount(), 0U) << "rejected as a whole";
  EXPECT_EQ(change(1.2, 0.6, "0, 4").at("invalid_states"), "0, 4");
  EXPECT_TRUE(waitUntil([this] {
    const EgoStatusConstPtr status = statuses_.latest();
    return status->return_count == 250 && status->dynamic_count == 50;
  }));
  EXPECT_EQ(change(1.2, 0.6, "0").at("invalid_states"), "0");
}

TEST_F(FaultsTest, ScaleOfTheDopplerAndOfOneRadarAlone) {
  const Recorder<TwistWithCovarianceStamped> reversed(handle_, "reversed/ego/twist");
  ASSERT_TRUE(reversed.grows(6));
  EXPECT_NEAR(reversed.messages().back()->twist.twist.linear.x, -8.0, 0.1);
}

TEST_F(FaultsTest, ARadarThatContradictsTheOthersIsNamed) {
  radars_.set(kBackLeft, [](PointCloud2& cloud) {
    for (const char* name : {"vx", "vy"}) edit(cloud, name, [](float value) { return -value; });
  });
  EXPECT_TRUE(
      diagnostics_.says("ego_velocity: radar back_left", DiagnosticStatus::WARN, "doppler_scale: -1"));
  expectTwistsGoOn();
  EXPECT_TRUE(diagnostics_.says("ego_velocity: radar front_left", DiagnosticStatus::OK, "Hz"));
  radars_.set(kBackLeft, {});
}

TEST_F(FaultsTest, OneRadarUnderTwoTopicsIsNamed) {
  const auto sent = std::make_shared<PointCloud2>();
  radars_.set(kFront, [sent](PointCloud2& cloud) { *sent = cloud; });
  radars_.set(kBackRight, [sent](PointCloud2& cloud) {
    if (!sent->data.empty()) cloud.data = sent->data;
  });
  EXPECT_TRUE(diagnostics_.says("ego_velocity: estimator", DiagnosticStatus::WARN, "send the same returns"));
  radars_.set(kFront, {});
  radars_.set(kBackRight, {});
  EXPECT_TRUE(diagnostics_.says("ego_velocity: estimator", DiagnosticStatus::OK, ""));
}

TEST_F(FaultsTest, OneRadarUnderTwoNamesIsTakenOnce) {
  EXPECT_TRUE(diagnostics_.says("watched: configuration", DiagnosticStatus::ERROR,
                                "radars/renamed has the topic of front, '/radar_front'"));
  EXPECT_EQ(diagnostics_.latest("watched: radar renamed").level, -1);
}

TEST_F(FaultsTest, OneRadarAndAnImuTellTheVelocity) {
  const Recorder<TwistWithCovarianceStamped> guided(handle_, "guided/ego/twist_raw");
  const LiveRotation rotation(handle_);
  ASSERT_TRUE(guided.grows(12));
  const TwistWithCovarianceStamped::ConstPtr twist = guided.messages().back();
  EXPECT_NEAR(twist->twist.twist.linear.x, LiveRadars::kSpeed, 0.1);
  EXPECT_NEAR(twist->twist.twist.linear.y, 0.0, 0.1);
  EXPECT_NEAR(twist->twist.twist.angular.z, LiveRadars::kYawRate, 1e-6) << "as the IMU says";
  EXPECT_LT(twist->twist.covariance[7], 0.1) << "vy is observed";
}

// The vehicle turns by 0.1 rad/s: 5.73 degrees per second.
TEST_F(FaultsTest, ARotationThatContradictsTheRadarsIsNamed) {
  LiveRotation rotation(handle_);
  const Recorder<nav_msgs::Odometry> gyro(handle_, "gyro/odom"), aided(handle_, "aided/odom");
  EXPECT_TRUE(diagnostics_.says("odometry_gyro: rotation", DiagnosticStatus::OK, "IMU"));
  EXPECT_TRUE(diagnostics_.says("odometry_aided: rotation", DiagnosticStatus::OK, "odometry"));
  rotation.gyro_factor = -1.0;
  EXPECT_TRUE(diagnostics_.says("odometry_gyro: rotation", DiagnosticStatus::WARN, "opposite signs"));
  rotation.gyro_factor = 1.0;
  EXPECT_TRUE(diagnostics_.says("odometry_gyro: rotation", DiagnosticStatus::OK, "IMU"));
  rotation.gyro_factor = 57.3;
  EXPECT_TRUE(diagnostics_.says("odometry_gyro: rotation", DiagnosticStatus::WARN, "in degrees per second"));
  EXPECT_TRUE(diagnostics_.says("guided: estimator", DiagnosticStatus::WARN, "in degrees per second"))
      << "by one radar";
}

TEST_F(FaultsTest, VelocitiesThatAreNoRangeRatesAreNamed) {
  const LiveRotation rotation(handle_);
  const Recorder<nav_msgs::Odometry> aided(handle_, "aided/odom");
  ASSERT_TRUE(aided.grows(6));
  const auto setRates = [this](float value) {
    radars_.setAll([value](PointCloud2& cloud) {
      for (const char* name : {"vx", "vy"}) edit(cloud, name, [value](float) { return value; });
    });
  };
  setRates(0.F);
  EXPECT_TRUE(diagnostics_.says("odometry_aided: rotation", DiagnosticStatus::ERROR,
                                "the range rates of the radars are zero, constant, or compensated"));
  EXPECT_TRUE(diagnostics_.says("watched: estimator", DiagnosticStatus::ERROR, "vx"));
  radars_.setAll({});
  EXPECT_TRUE(diagnostics_.says("odometry_aided: rotation", DiagnosticStatus::OK, "odometry"));
  expectTwistsGoOn();
}

TEST_F(FaultsTest, NumbersAtTheEdgeOfTheirTypeStayOutOfThePose) {
  const LiveRotation rotation(handle_);
  const Recorder<nav_msgs::Odometry> gyro(handle_, "gyro/odom"), aided(handle_, "aided/odom");
  ASSERT_TRUE(waitUntil([&] { return gyro.count() > 5 && aided.count() > 5; }));
  for (const double value : {std::nan(""), HUGE_VAL, 1e308, -1e308, 1e38, 1e-310, -1.0}) {
    for (std::size_t field = 0; field < 8; ++field) {
      rotation.publishBroken(value, field);
      ros::WallDuration(0.01).sleep();
    }
  }
  ASSERT_TRUE(waitUntil([&, before = gyro.count()] { return gyro.count() > before + 6; }));
  ASSERT_TRUE(aided.grows(6));
  for (const Recorder<nav_msgs::Odometry>* odometry : {&gyro, &aided}) {
    for (const auto& message : odometry->messages()) {
      const geometry_msgs::Pose& pose = message->pose.pose;
      EXPECT_LT(std::hypot(pose.position.x, pose.position.y, pose.position.z), 1e4);
      EXPECT_NEAR(std::hypot(pose.orientation.w, pose.orientation.x,
                             std::hypot(pose.orientation.y, pose.orientation.z)),
                  1.0, 1e-6);
      for (const double covariance : message->pose.covariance) EXPECT_TRUE(std::isfinite(covariance));
    }
  }
}

TEST_F(FaultsTest, MissingRadarsAndSilentSourcesAreReported) {
  EXPECT_TRUE(
      diagnostics_.says("unconfigured: configuration", DiagnosticStatus::ERROR, "/unconfigured/radars"));
  EXPECT_TRUE(diagnostics_.says("odometry_imu: rotation", DiagnosticStatus::ERROR, "nothing from IMU"));
  const Recorder<nav_msgs::Odometry> odometry(handle_, "imu/odom");
  EXPECT_TRUE(odometry.grows(6)) << "the yaw rate of the radars steps in";
}

// Largest step between two poses, m.
double largestStep(const std::vector<nav_msgs::OdometryConstPtr>& poses, std::size_t from) {
  double largest = 0.0;
  for (std::size_t i = std::max<std::size_t>(from, 1); i < poses.size(); ++i) {
    const auto &a = poses[i - 1]->pose.pose.position, &b = poses[i]->pose.pose.position;
    largest = std::max(largest, std::hypot(a.x - b.x, a.y - b.y));
  }
  return largest;
}

TEST_F(FaultsTest, WrongStampsResetNothing) {
  const Recorder<nav_msgs::Odometry> gyro(handle_, "gyro/odom"), aided(handle_, "aided/odom");
  const Recorder<rosgraph_msgs::Log> log(handle_, "/rosout");
  ros::Publisher twists = handle_.advertise<TwistWithCovarianceStamped>("ego/twist", 10);
  const LiveRotation rotation(handle_);
  ASSERT_TRUE(waitUntil([&] { return gyro.count() > 20 && aided.count() > 20; }));
  const std::size_t gyro_before = gyro.count(), aided_before = aided.count();
  const auto isReset = [](const rosgraph_msgs::LogConstPtr& line) {
    return line->msg.find("resetting") != std::string::npos;
  };
  const auto resets = [&] {
    const auto lines = log.messages();
    return std::count_if(lines.begin(), lines.end(), isReset);
  };
  const auto resets_before = resets();
  const auto expectAllGoOn = [&] {
    const std::size_t gyro_now = gyro.count(), aided_now = aided.count();
    EXPECT_TRUE(waitUntil([&] { return gyro.count() > gyro_now + 5 && aided.count() > aided_now + 5; }));
  };

  TwistWithCovarianceStamped twist;
  twist.header.frame_id = "base_link";
  twist.twist.twist.linear.x = 8.0;
  for (const double lead : {2.0, 100.0, -5.0}) {
    const ros::Time stamp = ros::Time::now() + ros::Duration(lead);
    rotation.publish(stamp);
    twist.header.stamp = stamp;
    twists.publish(twist);
    radars_.set(kFront, [stamp, done = std::make_shared<bool>(false)](PointCloud2& cloud) {
      if (!*done) cloud.header.stamp = stamp;
      *done = true;
    });
    expectAllGoOn();
  }
  radars_.set(kFront, {});
  rotation.publish(kLastStamp);
  twist.header.stamp = kLastStamp;
  twists.publish(twist);
  expectAllGoOn();

  expectTwistsGoOn();
  EXPECT_GT(gyro.count(), gyro_before + 20);
  EXPECT_GT(aided.count(), aided_before + 20);
  EXPECT_LT(largestStep(gyro.messages(), gyro_before), 8.5) << "8 m/s, a max_gap of 1 s";
  EXPECT_LT(largestStep(aided.messages(), aided_before), 8.5);
  EXPECT_EQ(resets(), resets_before);
  EXPECT_TRUE(waitUntil([&] { return log.count() > 0; })) << "the refusals are logged";
}

TEST_F(FaultsTest, OneBadValueTakesNothingWithIt) {
  const Recorder<TwistWithCovarianceStamped> misspelt(handle_, "misspelt/ego/twist");
  ASSERT_TRUE(misspelt.grows(6));
  EXPECT_NEAR(misspelt.messages().back()->twist.twist.linear.x, -8.0, 0.1) << "its doppler_scale counts";
  EXPECT_TRUE(diagnostics_.says("misspelt: configuration", DiagnosticStatus::ERROR, "planar_yew"));
  EXPECT_EQ(reconfigure("misspelt", {{"model", "planar"}}).at("model"), "planar");
  EXPECT_TRUE(diagnostics_.says("misspelt: configuration", DiagnosticStatus::OK, "radars"));
}

TEST_F(FaultsTest, WhatIsNotObservedAloneIsIntegratedAsGiven) {
  const Recorder<nav_msgs::Odometry> odometry(handle_, "lone/odom");
  ros::Publisher publisher = handle_.advertise<TwistWithCovarianceStamped>("lone/twist", 10);
  ASSERT_TRUE(waitUntil([&] { return odometry.connected() && publisher.getNumSubscribers() > 0; }));
  TwistWithCovarianceStamped twist;
  twist.header.frame_id = "base_link";
  twist.twist.twist.linear.x = 8.0;
  twist.twist.twist.linear.z = 5.0;
  for (const std::size_t i : {0U, 1U, 2U, 5U}) twist.twist.covariance[7 * i] = 1e6;
  const ros::Time begin = ros::Time::now();
  for (int i = 0; i < 20; ++i) {
    twist.header.stamp = begin + ros::Duration(0.05 * i);
    publisher.publish(twist);
    ros::WallDuration(0.05).sleep();
  }
  ASSERT_TRUE(waitUntil([&] { return odometry.count() >= 20; }));
  const auto poses = odometry.messages();
  const double duration = (poses.back()->header.stamp - poses.front()->header.stamp).toSec();
  EXPECT_NEAR(poses.back()->pose.pose.position.x, 8.0 * duration, 0.2);
  EXPECT_NEAR(poses.back()->pose.pose.position.z, 0.0, 1e-9) << "a climb is not measured";
  EXPECT_TRUE(diagnostics_.says("odometry_lone: odometry", DiagnosticStatus::ERROR,
                                "least sideslip assumed: vx, vy, wz"));
}

TEST_F(FaultsTest, AnotherNodeThatPublishesTheTransformIsNamed) {
  EXPECT_TRUE(diagnostics_.says("odometry: odometry", DiagnosticStatus::OK, "Hz"));
  {
    tf2_ros::TransformBroadcaster broadcaster;
    geometry_msgs::TransformStamped transform;
    transform.header.frame_id = "odom";
    transform.child_frame_id = "base_link";
    transform.transform.rotation.w = 1.0;
    const Ticker ticker(50.0, [&] {
      transform.header.stamp = ros::Time::now();
      broadcaster.sendTransform(transform);
    });
    EXPECT_TRUE(diagnostics_.says("odometry: odometry", DiagnosticStatus::WARN,
                                  ros::this_node::getName() + " publishes the transform to 'base_link'"));
    EXPECT_TRUE(diagnostics_.says("odometry_gyro: odometry", DiagnosticStatus::OK, "Hz"))
        << "publish_tf: false";
  }
  EXPECT_TRUE(diagnostics_.says("odometry: odometry", DiagnosticStatus::OK, "Hz"));
}

}  // namespace
}  // namespace radar_dot::test
