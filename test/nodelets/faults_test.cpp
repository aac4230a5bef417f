// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Five live radars, some of which fail in every known way; the others must not suffer.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Imu.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

#include "live_graph.h"
#include "radar_dot/EgoStatus.h"
#include "synthetic_bag.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using geometry_msgs::TwistWithCovarianceStamped;
using sensor_msgs::PointCloud2;

constexpr std::size_t kRadars = 5;
enum Radar : std::size_t { kFront, kFrontLeft, kFrontRight, kBackLeft, kBackRight };

/// Returns false when the radar is to stay silent.
using Fault = std::function<bool(PointCloud2&)>;

bool none(PointCloud2&) { return true; }
bool silent(PointCloud2&) { return false; }

TrueState steadyTurn() {
  TrueState state;
  state.speed = 8.0;
  state.yaw_rate = 0.1;
  return state;
}

// Publishes the scans of five radars at 13 Hz, each through its fault.
class LiveRadars {
 public:
  explicit LiveRadars(ros::NodeHandle& handle) {
    std::vector<geometry_msgs::TransformStamped> mounts;
    for (const SyntheticRadar& radar : syntheticRadars()) {
      mounts.push_back(radar.mount);
      mounts.back().header.stamp = ros::Time::now();
      publishers_.push_back(handle.advertise<PointCloud2>(radar.name, 10));
    }
    broadcaster_.sendTransform(mounts);
    faults_.fill(none);
    thread_ = std::thread([this] { run(); });
  }
  ~LiveRadars() {
    stop_ = true;
    thread_.join();
  }
  void set(std::size_t radar, const Fault& fault) {
    const std::lock_guard<std::mutex> lock(mutex_);
    faults_.at(radar) = fault;
  }
  void setAll(const Fault& fault) {
    for (std::size_t radar = 0; radar < kRadars; ++radar) set(radar, fault);
  }

 private:
  void run() {
    unsigned seed = 1;
    ros::WallRate rate(13.0 * kRadars);
    for (std::size_t radar = 0; !stop_ && ros::ok(); radar = (radar + 1) % kRadars) {
      PointCloud2 scan = syntheticScan(steadyTurn(), radar, ros::Time::now(), seed++);
      Fault fault;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        fault = faults_.at(radar);
      }
      if (fault(scan)) publishers_[radar].publish(scan);
      rate.sleep();
    }
  }

  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::vector<ros::Publisher> publishers_;
  std::array<Fault, kRadars> faults_;
  std::mutex mutex_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class FaultsTest : public ::testing::Test {
 protected:
  FaultsTest() {
    EXPECT_TRUE(waitUntil([this] { return twists_.connected() && statuses_.connected(); }, 10.0));
    EXPECT_TRUE(waitUntil([this] { return twists_.count() > 5; }, 5.0)) << "no twist from healthy radars";
  }

  // Twists go on, and every one of the next is the truth.
  void expectTwistsGoOn() {
    const std::size_t before = twists_.count();
    EXPECT_TRUE(waitUntil([&] { return twists_.count() >= before + 8; }, 2.0)) << "no twists any more";
    const auto twists = twists_.messages();
    for (std::size_t i = before; i < twists.size(); ++i) {
      EXPECT_NEAR(twists[i]->twist.twist.linear.x, 8.0, 0.05);
      EXPECT_NEAR(twists[i]->twist.twist.linear.y, 0.0, 0.05);
      EXPECT_NEAR(twists[i]->twist.twist.angular.z, 0.1, 0.03);
    }
  }

  bool diagnosed(const std::string& name, int level, const std::string& text) const {
    return waitUntil(
        [&] {
          const Diagnostics::Status status = diagnostics_.latest(name);
          return status.level == level && status.message.find(text) != std::string::npos;
        },
        4.0);
  }

  std::string heard(const std::string& name) const {
    const Diagnostics::Status status = diagnostics_.latest(name);
    return name + " is " + std::to_string(status.level) + ": " + status.message;
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
  radars_.set(kFrontLeft, silent);
  expectTwistsGoOn();
  EXPECT_TRUE(diagnosed("ego_velocity: radar front_left", DiagnosticStatus::ERROR, "silent"))
      << heard("ego_velocity: radar front_left");
  EXPECT_TRUE(diagnosed("ego_velocity: radar front", DiagnosticStatus::OK, "Hz"));
  // Once it is known to be silent it is not waited for: one twist per round of the others.
  const std::size_t before = twists_.count();
  ros::WallDuration(1.0).sleep();
  EXPECT_NEAR(static_cast<double>(twists_.count() - before), 13.0, 3.0);
  radars_.set(kFrontLeft, none);
  EXPECT_TRUE(diagnosed("ego_velocity: radar front_left", DiagnosticStatus::OK, "Hz"));
}

TEST_F(FaultsTest, BadCloudsAreRefusedWithTheirCause) {
  struct Kind {
    std::string cause;
    Fault fault;
    int level = DiagnosticStatus::ERROR;
  };
  const std::vector<Kind> kinds = {
      {"'vx'",
       [](PointCloud2& c) {
         c.fields.erase(c.fields.begin() + 6);
         return true;
       }},
      {"bytes of data",
       [](PointCloud2& c) {
         c.data.resize(c.data.size() / 2);
         return true;
       }},
      {"point_step",
       [](PointCloud2& c) {
         c.point_step = 0;
         return true;
       }},
      {"frame_id",
       [](PointCloud2& c) {
         c.header.frame_id.clear();
         return true;
       }},
      {"byte order",
       [](PointCloud2& c) {
         c.is_bigendian = 1;
         return true;
       }},
      {"stamp is zero",
       [](PointCloud2& c) {
         c.header.stamp = ros::Time();
         return true;
       }},
      {"ahead of the clock",
       [](PointCloud2& c) {
         c.header.stamp += ros::Duration(3600.0);
         return true;
       }},
      {"ahead of the clock",
       [](PointCloud2& c) {
         c.header.stamp = ros::Time(4'294'967'000U, 0);  // differences of ros::Time overflow
         return true;
       }},
      {"stamp not newer",
       [](PointCloud2& c) {
         c.header.stamp = ros::Time(5.0);
         return true;
       }},
      {"outside the window",
       [](PointCloud2& c) {
         c.header.stamp -= ros::Duration(0.3);
         return true;
       },
       DiagnosticStatus::WARN},
      {"does not fit",
       [](PointCloud2& c) {
         c.fields[0].offset = 4'000'000'000U;
         return true;
       }},
      {"no transform from 'nowhere' to 'base_link'",
       [](PointCloud2& c) {
         c.header.frame_id = "nowhere";
         return true;
       }},
  };
  const std::vector<std::pair<Radar, std::string>> victims = {
      {kFrontLeft, "front_left"}, {kFrontRight, "front_right"}, {kBackLeft, "back_left"}};
  for (std::size_t first = 0; first < kinds.size(); first += victims.size()) {
    for (std::size_t i = 0; i < victims.size(); ++i) radars_.set(victims[i].first, kinds.at(first + i).fault);
    expectTwistsGoOn();
    for (std::size_t i = 0; i < victims.size(); ++i) {
      const std::string name = "ego_velocity: radar " + victims[i].second;
      EXPECT_TRUE(diagnosed(name, kinds[first + i].level, kinds[first + i].cause))
          << "expected '" << kinds[first + i].cause << "', but " << heard(name);
    }
  }
}

TEST_F(FaultsTest, EmptyCloudsAndNothingButNaNAreHarmless) {
  radars_.set(kFrontLeft, [](PointCloud2& cloud) {
    cloud.width = cloud.row_step = 0;
    cloud.data.clear();
    return true;
  });
  radars_.set(kBackRight, [](PointCloud2& cloud) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < cloud.width; ++i)
      std::memcpy(&cloud.data[i * cloud.point_step], &nan, sizeof nan);
    return true;
  });
  expectTwistsGoOn();
  EXPECT_TRUE(diagnosed("ego_velocity: radar front_left", DiagnosticStatus::OK, "Hz"));
  EXPECT_TRUE(waitUntil(
      [this] {
        const auto values = diagnostics_.latest("ego_velocity: radar back_right").values;
        return values.count("returns not finite") == 1 && values.at("returns not finite") == "45";
      },
      3.0))
      << "45 of 50 returns pass the other filters";
}

TEST_F(FaultsTest, RefusedEstimateGivesAStatusAndNothingElse) {
  radars_.setAll([](PointCloud2& cloud) {
    cloud.width = 1;
    cloud.row_step = cloud.point_step;
    cloud.data.resize(cloud.row_step);
    return true;
  });
  ros::WallDuration(0.3).sleep();
  const std::size_t twists = twists_.count(), clouds = still_.count(), statuses = statuses_.count();
  EXPECT_TRUE(waitUntil([&] { return statuses_.count() > statuses + 5; }, 2.0));
  EXPECT_EQ(twists_.count(), twists);
  EXPECT_EQ(still_.count(), clouds);
  EXPECT_EQ(statuses_.messages().back()->status, EgoStatus::TOO_FEW_RETURNS);
  EXPECT_FALSE(statuses_.messages().back()->reason.empty());
  EXPECT_TRUE(diagnosed("ego_velocity: estimator", DiagnosticStatus::ERROR, "refused"))
      << heard("ego_velocity: estimator");
  // The odometry does not integrate over the gap that this makes.
  const auto at_gap = odometry_.messages().back();
  ros::WallDuration(0.3).sleep();
  radars_.setAll(none);
  const std::size_t poses = odometry_.count();
  ASSERT_TRUE(waitUntil([&] { return odometry_.count() > poses; }, 3.0));
  const auto after_gap = odometry_.messages().at(poses);
  EXPECT_GT((after_gap->header.stamp - at_gap->header.stamp).toSec(), 0.5);
  EXPECT_LT(std::hypot(after_gap->pose.pose.position.x - at_gap->pose.pose.position.x,
                       after_gap->pose.pose.position.y - at_gap->pose.pose.position.y),
            0.1);
  EXPECT_GT(after_gap->pose.covariance[0], at_gap->pose.covariance[0] + 1.0) << "the gap makes it uncertain";
}

TEST_F(FaultsTest, ThresholdChangesLiveAndInvalidValuesAreRejected) {
  const auto dynamicCount = [this] { return statuses_.messages().back()->dynamic_count; };
  EXPECT_EQ(dynamicCount(), 45U);
  const auto reconfigure = [](const std::vector<std::pair<std::string, double>>& numbers,
                              const std::string& invalid_states) {
    dynamic_reconfigure::Reconfigure call;
    for (const auto& [name, value] : numbers) {
      call.request.config.doubles.emplace_back();
      call.request.config.doubles.back().name = name;
      call.request.config.doubles.back().value = value;
    }
    call.request.config.strs.emplace_back();
    call.request.config.strs.back().name = "invalid_states";
    call.request.config.strs.back().value = invalid_states;
    if (!ros::service::call("ego_velocity/set_parameters", call)) return std::string("rejected");
    for (const auto& text : call.response.config.strs) {
      if (text.name == "invalid_states") return text.value;
    }
    return std::string("missing");
  };

  // Moving returns have residuals of 3 to 12 m/s: above 18 m/s nothing is dynamic.
  EXPECT_EQ(reconfigure({{"isolated_threshold", 18.0}, {"supported_threshold", 18.0}}, "0"), "0");
  EXPECT_TRUE(waitUntil([&] { return dynamicCount() == 0; }, 2.0)) << dynamicCount();
  EXPECT_EQ(reconfigure({{"isolated_threshold", 1.2}, {"supported_threshold", 0.6}}, "nine"), "rejected");
  ros::WallDuration(0.3).sleep();
  EXPECT_EQ(dynamicCount(), 0U) << "rejected as a whole";
  EXPECT_EQ(reconfigure({{"isolated_threshold", 1.2}, {"supported_threshold", 0.6}}, "0, 4"), "0, 4");
  EXPECT_TRUE(waitUntil([&] { return statuses_.messages().back()->return_count == 250U; }, 2.0));
  EXPECT_EQ(dynamicCount(), 50U);
  EXPECT_EQ(reconfigure({}, "0"), "0");
}

TEST_F(FaultsTest, ScaleOfTheDopplerAndOfOneRadarAlone) {
  const Recorder<TwistWithCovarianceStamped> reversed(handle_, "reversed/ego/twist");
  ASSERT_TRUE(waitUntil([&] { return reversed.count() > 5; }, 5.0));
  EXPECT_NEAR(reversed.messages().back()->twist.twist.linear.x, -8.0, 0.1);
}

TEST_F(FaultsTest, MissingRadarsAndSilentSourcesAreReported) {
  EXPECT_TRUE(diagnosed("unconfigured: configuration", DiagnosticStatus::ERROR, "/unconfigured/radars"))
      << heard("unconfigured: configuration");
  EXPECT_TRUE(diagnosed("odometry_imu: rotation", DiagnosticStatus::ERROR, "nothing from IMU"))
      << heard("odometry_imu: rotation");
  const Recorder<nav_msgs::Odometry> odometry(handle_, "imu/odom");
  EXPECT_TRUE(waitUntil([&] { return odometry.count() > 5; }, 3.0)) << "the yaw rate of the radars steps in";
}

// Publishes the rotation of the steady turn at 50 Hz, as an IMU and as an odometry.
class LiveRotation {
 public:
  explicit LiveRotation(ros::NodeHandle& handle)
      : imu_(handle.advertise<sensor_msgs::Imu>("test/imu", 10)),
        odometry_(handle.advertise<nav_msgs::Odometry>("test/odom", 10)),
        thread_([this] { run(); }) {}
  ~LiveRotation() {
    stop_ = true;
    thread_.join();
  }
  void publish(const ros::Time& stamp) {
    sensor_msgs::Imu imu;
    imu.header.stamp = stamp;
    imu.header.frame_id = "base_link";
    imu.angular_velocity.z = 0.1;
    imu_.publish(imu);
    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = "map";
    odometry.child_frame_id = "base_link";
    const double yaw = 0.1 * (stamp - start_).toSec();
    odometry.pose.pose.orientation.w = std::cos(0.5 * yaw);
    odometry.pose.pose.orientation.z = std::sin(0.5 * yaw);
    odometry_.publish(odometry);
  }
  /// The same with a stamp that no difference of ros::Time survives.
  void publishTheLastStampThereIs() {
    sensor_msgs::Imu imu;
    imu.header.stamp = ros::Time(4'294'967'000U, 0);
    imu.header.frame_id = "base_link";
    imu_.publish(imu);
    nav_msgs::Odometry odometry;
    odometry.header.stamp = imu.header.stamp;
    odometry.pose.pose.orientation.w = 1.0;
    odometry_.publish(odometry);
  }

 private:
  void run() {
    for (ros::WallRate rate(50.0); !stop_ && ros::ok(); rate.sleep()) publish(ros::Time::now());
  }
  ros::Time start_ = ros::Time::now();
  ros::Publisher imu_, odometry_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

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
  LiveRotation rotation(handle_);
  ASSERT_TRUE(waitUntil([&] { return gyro.count() > 60 && aided.count() > 60; }, 15.0));
  const std::size_t gyro_before = gyro.count(), aided_before = aided.count();
  const auto isReset = [](const rosgraph_msgs::LogConstPtr& line) {
    return line->msg.find("resetting") != std::string::npos;
  };
  const auto resets = [&] {
    const auto lines = log.messages();
    return std::count_if(lines.begin(), lines.end(), isReset);
  };
  const auto resets_before = resets();

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
      return true;
    });
    ros::WallDuration(0.5).sleep();
  }
  radars_.set(kFront, none);
  rotation.publishTheLastStampThereIs();
  twist.header.stamp = ros::Time(4'294'967'000U, 0);
  twists.publish(twist);
  ros::WallDuration(0.5).sleep();

  expectTwistsGoOn();
  EXPECT_GT(gyro.count(), gyro_before + 20);
  EXPECT_GT(aided.count(), aided_before + 20);
  EXPECT_LT(largestStep(gyro.messages(), gyro_before), 3.0) << "8 m/s";
  EXPECT_LT(largestStep(aided.messages(), aided_before), 3.0);
  EXPECT_EQ(resets(), resets_before);
  EXPECT_GT(log.count(), 0U) << "the refusals are logged";
}

TEST_F(FaultsTest, OneBadValueTakesNothingWithIt) {
  const Recorder<TwistWithCovarianceStamped> misspelt(handle_, "misspelt/ego/twist");
  ASSERT_TRUE(waitUntil([&] { return misspelt.count() > 5; }, 5.0));
  EXPECT_NEAR(misspelt.messages().back()->twist.twist.linear.x, -8.0, 0.1) << "its doppler_scale counts";
  EXPECT_TRUE(diagnosed("misspelt: configuration", DiagnosticStatus::ERROR, "planar_yew"))
      << heard("misspelt: configuration");
  dynamic_reconfigure::Reconfigure call;
  call.request.config.strs.emplace_back();
  call.request.config.strs.back().name = "model";
  call.request.config.strs.back().value = "planar";
  EXPECT_TRUE(ros::service::call("misspelt/set_parameters", call));
  EXPECT_TRUE(diagnosed("misspelt: configuration", DiagnosticStatus::OK, "radars"))
      << heard("misspelt: configuration");
}

TEST_F(FaultsTest, WhatIsNotObservedAloneIsIntegratedAsGiven) {
  const Recorder<nav_msgs::Odometry> odometry(handle_, "lone/odom");
  ros::Publisher publisher = handle_.advertise<TwistWithCovarianceStamped>("lone/twist", 10);
  ASSERT_TRUE(waitUntil([&] { return odometry.connected() && publisher.getNumSubscribers() > 0; }, 5.0));
  TwistWithCovarianceStamped twist;
  twist.header.frame_id = "base_link";
  twist.twist.twist.linear.x = 8.0;
  twist.twist.twist.linear.z = 5.0;
  for (const std::size_t i : {0U, 1U, 2U, 5U}) twist.twist.covariance[7 * i] = 1e6;
  for (int i = 0; i < 20; ++i) {
    twist.header.stamp = ros::Time::now();
    publisher.publish(twist);
    ros::WallDuration(0.05).sleep();
  }
  ASSERT_TRUE(waitUntil([&] { return odometry.count() >= 20; }, 2.0));
  const auto poses = odometry.messages();
  const double duration = (poses.back()->header.stamp - poses.front()->header.stamp).toSec();
  EXPECT_NEAR(poses.back()->pose.pose.position.x, 8.0 * duration, 0.2);
  EXPECT_NEAR(poses.back()->pose.pose.position.z, 0.0, 1e-9) << "a climb is not measured";
  EXPECT_TRUE(
      diagnosed("odometry_lone: odometry", DiagnosticStatus::ERROR, "least sideslip assumed: vx, vy, wz"))
      << heard("odometry_lone: odometry") << " (it is silent by now)";
}

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "faults_test");
  ros::AsyncSpinner spinner(1);
  ros::NodeHandle keep_alive;
  spinner.start();
  return RUN_ALL_TESTS();
}
