// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <geometry_msgs/TwistStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rapidjson/document.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <tf2_msgs/TFMessage.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/tool_run.h"
#include "nodelets/float_cloud.h"

namespace radar_dot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Radar {
  std::string name;
  double x, y, yaw;  // m, rad, as TF says
  double turned;     // rad, beyond that
};
const std::vector<Radar> kRadars = {
    {"front", 3.4, 0.0, 0.0, 0.020}, {"left", 2.4, 0.8, 1.57, -0.015}, {"back", -0.6, 0.0, 3.14, 0.010}};

struct Motion {
  double speed, yaw_rate, lateral;
};
Motion winding(double t) {
  return {10.0 + 3.0 * std::sin(0.7 * t), 0.3 * std::sin(0.5 * t), 0.05 * std::sin(2.0 * t)};
}
Motion straight(double) { return {12.0, 0.0, 0.001}; }

class CalibrateRecording : public testing::Test {
 protected:
  CalibrateRecording() : bag_(path("drive.bag"), rosbag::bagmode::Write) {
    test::writeFile(config(),
                    fmt::format("ego_velocity:\n  radars:\n    front: {{topic: radars/front}}\n"
                                "    left: {{topic: /radars/left}}\n    back: {{topic: "
                                "radars/back, mount_xyz: [-0.6, 0, 0], mount_rpy: [0, 0, 3.14]}}\n"));
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string config() const { return path("config.yaml"); }

  template <typename Message>
  void write(const std::string& topic, double time, Message message, const std::string& frame) {
    message.header.stamp = ros::Time(start_ + time);
    message.header.frame_id = frame;
    bag_.write(topic, message.header.stamp, message);
  }

  void mount(const std::string& topic, double time, const std::string& parent, const std::string& child,
             const Eigen::Vector3d& position, double yaw, bool is_flipped = false) {
    geometry_msgs::TransformStamped one;
    one.header.stamp = ros::Time(start_ + time);
    one.header.frame_id = parent;
    one.child_frame_id = child;
    one.transform.translation.x = position.x();
    one.transform.translation.y = position.y();
    one.transform.rotation.w = is_flipped ? 0.0 : std::cos(0.5 * yaw);
    one.transform.rotation.z = std::sin(0.5 * yaw);
    one.transform.rotation.x = is_flipped ? 1.0 : 0.0;
    tf2_msgs::TFMessage message;
    message.transforms.push_back(one);
    bag_.write(topic, one.header.stamp, message);
  }

  /// The front radar is mounted by TF that repeats, the left one by a static one on a bumper.
  void mounts() {
    mount("/tf_static", 0.0, "base_link", "bumper", {2.4, 0.0, 0.0}, 0.0);
    mount("/tf_static", 0.0, "bumper", "left", {0.0, 0.8, 0.0}, 1.57);
    for (int i = 0; i < 5; ++i) mount("/tf", 4.0 * i, "base_link", "front", {3.4, 0.0, 0.0}, 0.0);
  }

  /// @param turned  factor on what the radars are turned by, over time
  template <typename Turned>
  void drive(Motion (*motion)(double), const Turned& turned) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise;
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (const Radar& radar : kRadars) {
      for (double time = 0.01 * radar.yaw; time < duration_; time += 0.077) {
        const Motion m = motion(time);
        std::vector<float> values;
        for (int i = 0; i < 25; ++i) {
          const double bearing = uniform(random);
          const double angle = bearing + radar.yaw + radar.turned * turned(time);
          double rate = -(std::cos(angle) * (m.speed - m.yaw_rate * radar.y) +
                          std::sin(angle) * (m.lateral + m.yaw_rate * radar.x));
          if (i < 3) rate += 8.0 * uniform(random);  // moves
          for (const double value :
               {20.0 * std::cos(bearing), 20.0 * std::sin(bearing), 0.0, rate + 0.03 * noise(random)})
            values.push_back(static_cast<float>(value));
        }
        write("/radars/" + radar.name, time, test::floatCloud({"x", "y", "z", "doppler"}, values),
              radar.name);
      }
    }
    for (double time = 0.0; time < duration_; time += 0.05) {
      nav_msgs::Odometry odometry;
      odometry.child_frame_id = "base_link";
      odometry.pose.pose.orientation.w = 1.0;
      odometry.twist.twist.linear.x = motion(time).speed;
      odometry.twist.twist.linear.y = motion(time).lateral;
      odometry.twist.twist.angular.z = motion(time).yaw_rate;
      write("/odom", time, odometry, "odom");
      geometry_msgs::TwistStamped speed;
      speed.twist.linear.x = motion(time).speed;
      write("/speed", time, speed, "base_link");
      sensor_msgs::Imu imu;
      imu.angular_velocity.z = -motion(time).yaw_rate + 0.02;
      write("/imu", time, imu, "imu");
    }
  }

  std::string command(const std::string& arguments) {
    if (bag_.isOpen()) bag_.close();
    return fmt::format("{} {} --config {} {}", TOOL, path("drive.bag"), config(), arguments);
  }
  std::string textOf(const std::string& arguments) {
    const test::Outcome outcome =
        test::runCommand(command("--json " + path("report.json") + " " + arguments));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return outcome.text;
  }
  rapidjson::Document report() const {
    rapidjson::Document document;
    document.Parse(test::readFile(path("report.json")).c_str());
    EXPECT_FALSE(document.HasParseError());
    return document;
  }
  /// @param share  of the turn that is left
  void expectYaws(double share, double tolerance = 0.002) const {
    const rapidjson::Document document = report();
    for (const Radar& radar : kRadars)
      EXPECT_NEAR(document["overall"][radar.name.c_str()]["yaw"].GetDouble(), share * radar.turned, tolerance)
          << radar.name;
  }
  void refuse(const std::string& arguments, const std::string& part) {
    test::expectOneLineRefusal(command(arguments), "calibrate_radars", part);
  }

  test::TemporaryFolder folder_;
  rosbag::Bag bag_;
  double start_ = 1000.0, duration_ = 20.0;  // s
};

double constantly(double) { return 1.0; }

TEST_F(CalibrateRecording, FindsTurnedMountsAndWhatItWritesCuresThem) {
  mounts();
  drive(winding, constantly);
  const std::string text =
      textOf("--reference odom --mount-yaws " + path("yaws.yaml") + " --mounts " + path("mounts.yaml"));
  expectYaws(1.0);
  EXPECT_EQ(report()["overall"]["is_worth_it"].GetInt(), 1);
  EXPECT_EQ(report()["overall"]["front"]["doppler_sign"].GetDouble(), 1.0);
  const std::string yaws = test::readFile(path("yaws.yaml"));
  EXPECT_THAT(yaws, AllOf(HasSubstr("front: {yaw: 0.0"), HasSubstr("left: {yaw: -0.01"), HasSubstr("back:")));

  // Mounts of the file take the place of those of the recording; the third has its own in the configuration.
  textOf("--reference odom --tf " + path("mounts.yaml"));
  const rapidjson::Document cured = report();
  EXPECT_NEAR(cured["overall"]["front"]["yaw"].GetDouble(), 0.0, 0.002);
  EXPECT_NEAR(cured["overall"]["left"]["yaw"].GetDouble(), 0.0, 0.002);

  test::writeFile(path("pasted.yaml"), text.substr(text.find("ego_velocity:")));
  EXPECT_THAT(text, HasSubstr("mount_xyz: [-0.6, 0, 0]"));
  textOf("--reference odom --config " + path("pasted.yaml"));
  expectYaws(0.0);
}

TEST_F(CalibrateRecording, DrivesOnSeveralDaysAreOneVehicle) {
  mounts();
  duration_ = 10.0;
  drive(winding, constantly);
  start_ += 1e6;
  drive(winding, constantly);
  textOf("--reference /odom");
  expectYaws(1.0);
  test::expectReportRepeatsRun(TOOL, path("drive.bag") + " --config " + config() + " --reference /odom");
}

TEST_F(CalibrateRecording, AGyroscopeMayBeUpsideDownAndBiased) {
  mounts();
  mount("/tf_static", 0.0, "base_link", "imu", {1.0, 0.0, 0.0}, 0.0, true);
  drive(winding, constantly);
  textOf("--reference /speed,/imu --no-positions");
  expectYaws(1.0, 0.004);
}

TEST_F(CalibrateRecording, AStraightDriveSaysWhatItDoesNotShow) {
  mounts();
  drive(straight, constantly);
  EXPECT_THAT(textOf("--reference /odom"), HasSubstr("front x"));
  const rapidjson::Document found = report();
  for (const char* quantity : {"x", "y", "time_offset"})
    EXPECT_TRUE(found["overall"]["front"][quantity].IsNull()) << quantity;
  EXPECT_TRUE(found["overall"]["bearing_delay"].IsNull());
}

TEST_F(CalibrateRecording, WritesNothingThatIsWorse) {
  mounts();
  drive(winding, [](double time) { return std::fmod(time, 10.0) < 5.0 ? 1.0 : -1.0; });
  const std::string text =
      textOf("--reference /odom --block 5 --mount-yaws " + path("yaws.yaml") + " --mounts " + path("m.yaml"));
  EXPECT_THAT(text, AllOf(HasSubstr("nothing to paste"), HasSubstr("yaws.yaml is not written")));
  EXPECT_EQ(report()["overall"]["is_worth_it"].GetInt(), 0);
  EXPECT_FALSE(std::filesystem::exists(path("yaws.yaml")));
  EXPECT_FALSE(std::filesystem::exists(path("m.yaml")));
}

TEST_F(CalibrateRecording, SaysWhatIsMissing) {
  duration_ = 2.0;
  mount("/tf", 0.0, "base_link", "front", {3.4, 0.0, 0.0}, 0.0);
  drive(straight, constantly);
  refuse("", "--reference: it must be given; of the types");
  refuse("--reference /odo", "/odom (nav_msgs/Odometry)");
  refuse("--reference /odom",
         "radars/left: no transform from 'left' to 'base_link' in the recording: give it by --tf");
  refuse("--reference /imu", "/imu: no transform from 'imu' to 'base_link'");
  test::writeFile(path("tf.yaml"), "- {parent: base_link, child: left, heading: 1.57}\n");
  refuse("--reference /odom --tf " + path("tf.yaml"), "tf.yaml:1: unknown parameter heading");
  test::writeFile(config(), "ego_velocity: {radars: {front: {topic: radars/frnt}}}\n");
  refuse("--reference /odom",
         "radars/front/topic: /radars/frnt is not in the recording; of the types that serve "
         "(sensor_msgs/PointCloud2) there are: /radars/back");
  test::writeFile(config(), "ego_velocity: {radars: {front: {topic: radars/front}}, doppler_field: speed}\n");
  refuse("--reference /odom", "radars/front: /radars/front: ");
  test::writeFile(config(), "ego_velocity: {}\n");
  refuse("--reference /odom", "no radars: --config FILE");
}

}  // namespace
}  // namespace radar_dot
