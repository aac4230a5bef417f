// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/recorded_motion.h"

#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <radar_dot/MovingObjects.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/NavSatFix.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/tool_run.h"

namespace radar_dot::evaluation {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kStart = 1000.0;  // s

double figure(const MotionReport& report, const std::string& key) {
  const Figures figures = figuresOf(report);
  const Figures::Item* item = figures.find(key);
  EXPECT_NE(item, nullptr) << key;
  if (item == nullptr) return std::numeric_limits<double>::quiet_NaN();
  return item->kind == Figures::Kind::kCount ? static_cast<double>(item->count) : item->number;
}

class RecordedMotionTest : public testing::Test {
 protected:
  RecordedMotionTest() : bag_((folder_.path() / "drive.bag").string(), rosbag::bagmode::Write) {
    options_.reference = "/truth";
  }

  template <typename Message>
  void write(const std::string& topic, double time, Message message, const std::string& frame) {
    message.header.stamp = ros::Time(kStart + time);
    message.header.frame_id = frame;
    bag_.write(topic, message.header.stamp, message);
  }

  /// @param variance  of vx, vy and the yaw rate
  void estimate(double time, double vx, double vy, double yaw_rate, double variance = 0.01) {
    geometry_msgs::TwistWithCovarianceStamped message;
    message.twist.twist.linear.x = vx;
    message.twist.twist.linear.y = vy;
    message.twist.twist.angular.z = yaw_rate;
    for (const std::size_t axis : {0, 1, 5}) message.twist.covariance[7 * axis] = variance;
    write("/ego/twist", time, message, "base_link");
  }

  void truth(double time, double vx, double vy, double yaw_rate, const std::string& frame = "base_link") {
    geometry_msgs::TwistStamped message;
    message.twist.linear.x = vx;
    message.twist.linear.y = vy;
    message.twist.angular.z = yaw_rate;
    write("/truth", time, message, frame);
  }

  static nav_msgs::Odometry odometryOf(double x, double y, double yaw) {
    nav_msgs::Odometry message;
    message.child_frame_id = "base_link";
    message.pose.pose.position.x = x;
    message.pose.pose.position.y = y;
    message.pose.pose.orientation.w = std::cos(0.5 * yaw);
    message.pose.pose.orientation.z = std::sin(0.5 * yaw);
    return message;
  }

  void transform(const std::string& topic, double time, const std::string& parent, const std::string& child,
                 double x, double yaw) {
    geometry_msgs::TransformStamped one;
    one.header.stamp = ros::Time(kStart + time);
    one.header.frame_id = parent;
    one.child_frame_id = child;
    one.transform.translation.x = x;
    one.transform.rotation.w = std::cos(0.5 * yaw);
    one.transform.rotation.z = std::sin(0.5 * yaw);
    tf2_msgs::TFMessage message;
    message.transforms.push_back(one);
    bag_.write(topic, one.header.stamp, message);
  }

  MotionReport evaluate() {
    bag_.close();
    return evaluateRecording(bag::BagInput({folder_.path() / "drive.bag"}), options_,
                             [this](const std::string& doubt) { doubts_.push_back(doubt); });
  }

  std::string refusal() {
    try {
      evaluate();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
  rosbag::Bag bag_;
  RecordingOptions options_;
  std::vector<std::string> doubts_;
};

TEST_F(RecordedMotionTest, ConstantErrorOfTheSpeed) {
  for (int i = 0; i <= 100; ++i) truth(0.1 * i, 10.0, 0.0, 0.1);
  for (int i = 0; i < 50; ++i) estimate(0.1 * i + 0.05, 10.3, 0.0, 0.1);
  const MotionReport report = evaluate();
  for (const char* key : {"vx/mae", "vx/rmse", "vx/bias", "vx/p95"})
    EXPECT_NEAR(figure(report, key), 0.3, 1e-9);
  EXPECT_NEAR(figure(report, "vx/nees"), 9.0, 1e-6);
  EXPECT_NEAR(figure(report, "joint/nees"), 3.0, 1e-6);
  EXPECT_NEAR(figure(report, "vy/mae"), 0.0, 1e-9);
  EXPECT_NEAR(figure(report, "yaw_rate/mae"), 0.0, 1e-9);
  EXPECT_EQ(figure(report, "vx/count"), 50);
  EXPECT_NEAR(figure(report, "estimate/rate"), 10.0, 1e-6);
  EXPECT_NEAR(figure(report, "reference/longest_gap"), 0.1, 1e-6);
  EXPECT_TRUE(doubts_.empty());
}

// Half a circle of 20 m, 1 % too fast: 20.2 m. The ends are twice the difference of the radii apart.
TEST_F(RecordedMotionTest, DriftOnACircle) {
  constexpr double kRate = 0.5, kRadius = 20.0;
  const int steps = 400;
  for (int i = 0; i <= steps; ++i) {
    const double yaw = M_PI * i / steps, time = yaw / kRate;
    nav_msgs::Odometry odometry = odometryOf(kRadius * std::sin(yaw), kRadius * (1.0 - std::cos(yaw)), yaw);
    odometry.twist.twist.linear.x = kRate * kRadius;
    odometry.twist.twist.angular.z = kRate;
    write("/truth", time, odometry, "map");
    estimate(time, 1.01 * kRate * kRadius, 0.0, kRate);
    // Another origin and another heading: 2 % too large.
    write("/odom", time,
          odometryOf(7.0 + 1.02 * kRadius * (1.0 - std::cos(yaw)), -1.02 * kRadius * std::sin(yaw),
                     yaw - M_PI_2),
          "odom");
  }
  const MotionReport report = evaluate();
  const double length = M_PI * kRadius;
  for (const char* path : {"reference_heading", "own_heading"}) {
    const std::string key = std::string("trajectory/") + path;
    EXPECT_NEAR(figure(report, key + "/distance"), length, 0.01);
    EXPECT_NEAR(figure(report, key + "/drift_percent"), 100.0 * 0.4 / length, 0.01);
    // The chord of the angle a is off by 0.2 m 2 sin(a / 2), whose mean square is 2 (0.2 m)^2.
    EXPECT_NEAR(figure(report, key + "/ate_rmse"), 0.2 * std::sqrt(2.0), 0.002);
    // Less their mean, 0.2 m (2 / pi, 1); they point away from the centre, so that no turn helps.
    EXPECT_NEAR(figure(report, key + "/ate_rmse_aligned"), 0.2 * std::sqrt(1.0 - 4.0 / (M_PI * M_PI)), 0.002);
  }
  EXPECT_NEAR(figure(report, "trajectory/odometry/drift_percent"), 100.0 * 0.8 / length, 0.01);
}

class LateEstimateTest : public RecordedMotionTest {
 protected:
  LateEstimateTest() {
    const auto speed = [](double t) { return 8.0 + 2.0 * std::sin(0.8 * t); };
    const auto yaw_rate = [](double t) { return 0.3 * std::sin(0.5 * t); };
    for (int i = 0; i < 1000; ++i) truth(0.02 * i, speed(0.02 * i), 0.0, yaw_rate(0.02 * i));
    for (int i = 10; i < 240; ++i) {
      const double now = i / 13.0, noise = i % 2 == 0 ? 0.02 : -0.02;
      estimate(now + 0.1, speed(now) + noise, 0.0, yaw_rate(now) + 0.1 * noise);
    }
  }
};

TEST_F(LateEstimateTest, IsSeen) {
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "time_offset/found"), -0.1, 0.005);
  EXPECT_LT(figure(report, "time_offset/sigma"), 0.005);
  EXPECT_EQ(figure(report, "time_offset/added"), 0.0);
  EXPECT_GT(figure(report, "vx/mae"), 0.08);  // 0.1 s of a mean acceleration of 1 m/s^2
}

TEST_F(LateEstimateTest, IsCorrectedWhereAsked) {
  options_.comparison.align_time = true;
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "time_offset/added"), -0.1, 0.005);
  EXPECT_NEAR(figure(report, "vx/mae"), 0.02, 0.003);
}

TEST_F(LateEstimateTest, IsCorrectedByAGivenOffset) {
  options_.comparison.time_offset = -0.1;
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "time_offset/found"), -0.1, 0.005);
  EXPECT_NEAR(figure(report, "vx/mae"), 0.02, 0.001);
}

TEST_F(RecordedMotionTest, SteadyDriveShowsNoTimeOffset) {
  options_.comparison.align_time = true;
  for (int i = 0; i < 200; ++i) truth(0.1 * i, 10.0 + (i % 3 == 0 ? 0.02 : -0.01), 0.0, 0.0);
  for (int i = 10; i < 190; ++i) estimate(0.1 * i, 10.0 + (i % 2 == 0 ? 0.02 : -0.02), 0.0, 0.0);
  const MotionReport report = evaluate();
  EXPECT_FALSE(report.time_offset.why_not.empty());
  EXPECT_TRUE(std::isnan(figure(report, "time_offset/found")));
  EXPECT_EQ(figure(report, "time_offset/added"), 0.0);
  EXPECT_THAT(formatTable(report), HasSubstr("not seen"));
}

// Errors of 0.2 m/s in turn, and a variance of (0.1 m/s)^2.
TEST_F(RecordedMotionTest, CovarianceThatIsTooSmall) {
  for (int i = 0; i <= 100; ++i) {
    truth(0.1 * i, 10.0, 0.0, 0.0);
    geometry_msgs::TwistWithCovarianceStamped message;
    message.twist.twist.linear.x = 10.0 + (i % 2 == 0 ? 0.2 : -0.2);
    message.twist.covariance[0] = 0.01;
    message.twist.covariance[7] = 1e6;  // vy is not known, and nothing is said of the yaw rate's sigma
    write("/ego/twist", 0.1 * i, message, "base_link");
  }
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "vx/nees"), 4.0, 1e-6);
  EXPECT_EQ(figure(report, "vy/count"), 0);
  EXPECT_EQ(figure(report, "yaw_rate/count"), 101);
  EXPECT_NEAR(figure(report, "joint/nees"), 4.0, 1e-6);
  // Chi-square of 101 degrees of freedom: 75.1 and 130.7 (tables).
  EXPECT_NEAR(figure(report, "joint/lower_limit"), 0.744, 0.01);
  EXPECT_NEAR(figure(report, "joint/upper_limit"), 1.294, 0.01);
  EXPECT_EQ(figure(report, "joint/within_95"), 0.0);
  EXPECT_THAT(formatTable(report), HasSubstr("Covariance: too small"));
}

// 2 m ahead of the base frame a turn of 0.5 rad/s moves by 1 m/s to the left, which is ahead in axes turned
// by 90 degrees.
TEST_F(RecordedMotionTest, LeverArmOfTheReference) {
  transform("/tf_static", 0.0, "base_link", "gnss", 2.0, M_PI_2);
  for (int i = 0; i <= 50; ++i) {
    truth(0.1 * i, 1.0, -5.0, 0.5, "gnss");
    estimate(0.1 * i, 5.0, 0.0, 0.5);
  }
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "vx/mae"), 0.0, 1e-9);
  EXPECT_NEAR(figure(report, "vy/mae"), 0.0, 1e-9);
  EXPECT_TRUE(doubts_.empty());
}

TEST_F(RecordedMotionTest, UnknownLeverArmIsTold) {
  for (int i = 0; i <= 50; ++i) {
    truth(0.1 * i, 5.0, 1.0, 0.5, "gnss");
    estimate(0.1 * i, 5.0, 0.0, 0.5);
  }
  EXPECT_NEAR(figure(evaluate(), "vy/bias"), -1.0, 1e-9);
  EXPECT_THAT(doubts_, ElementsAre(AllOf(HasSubstr("/truth"), HasSubstr("gnss"), HasSubstr("base_link"))));
}

// A circle of 100 m at 10 m/s on the equator, where a degree has 111319.49 m to the east and 110574.27 m to
// the north.
TEST_F(RecordedMotionTest, PairsOfFixes) {
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.1 * 0.05 * i;
    sensor_msgs::NavSatFix fix;
    fix.latitude = 100.0 * (1.0 - std::cos(angle)) / 110574.27;
    fix.longitude = 100.0 * std::sin(angle) / 111319.49;
    if (i == 50) fix.status.status = sensor_msgs::NavSatStatus::STATUS_NO_FIX;
    write("/truth", 0.05 * i, fix, "base_link");
    estimate(0.05 * i, 10.0, 0.0, 0.1);
  }
  const MotionReport report = evaluate();
  EXPECT_EQ(figure(report, "reference/messages"), 201);
  EXPECT_EQ(figure(report, "reference/no_fix"), 1);
  EXPECT_LT(figure(report, "vx/mae"), 0.002);
  EXPECT_LT(figure(report, "yaw_rate/mae"), 0.002);
  EXPECT_EQ(figure(report, "vy/count"), 0);  // a course tells nothing of it
  EXPECT_LT(figure(report, "trajectory/own_heading/ate_rmse"), 0.15);
}

TEST_F(RecordedMotionTest, Transforms) {
  options_.reference = "tf:map:base_link";
  for (int i = 0; i <= 50; ++i) {
    if (i % 10 == 0) transform("/tf", 0.1 * i, "map", "odom", 3.0, 0.3);
    transform("/tf", 0.1 * i, "odom", "base_link", 0.5 * i, 0.0);
    estimate(0.1 * i, 5.2, 0.0, 0.0);
  }
  const MotionReport report = evaluate();
  EXPECT_NEAR(figure(report, "vx/bias"), 0.2, 1e-6);
  EXPECT_NEAR(figure(report, "trajectory/own_heading/drift_percent"), 4.0, 1e-3);
}

TEST_F(RecordedMotionTest, VelocityOfPoses) {
  for (int i = 0; i <= 50; ++i) {
    write("/truth", 0.1 * i, odometryOf(0.5 * i, 0.0, 0.0), "map");  // without twists
    estimate(0.1 * i, 5.2, 0.0, 0.0);
  }
  EXPECT_NEAR(figure(evaluate(), "vx/bias"), 0.2, 1e-6);
}

// Accelerating by 2 m/s^2; the estimate is 0.1 m/s too fast from half-way between the keyframes on, for a
// while.
TEST_F(RecordedMotionTest, OnceBetweenKeyframes) {
  options_.keyframes = "/boxes";
  for (int i = 0; i <= 200; ++i) {
    const double time = 0.02 * i;
    truth(time, 5.0 + 2.0 * time, 0.0, 0.0);
    for (int copies = 0; i % 25 == 0 && copies < 2; ++copies)
      write("/boxes", time, sensor_msgs::Image(), "map");
    if (i % 3 != 0) continue;
    const double since = std::fmod(time, 0.5);
    const bool is_late = since > 0.26 && since < 0.43;
    estimate(time, 5.0 + 2.0 * time + (is_late ? 0.1 : 0.0), 0.0, 0.0);
  }
  const MotionReport report = evaluate();
  EXPECT_EQ(figure(report, "compared"), 8);
  EXPECT_NEAR(figure(report, "vx/mae"), 0.0, 1e-6);
}

TEST_F(RecordedMotionTest, SaysThatThereAreNoKeyframes) {
  options_.keyframes = "/boxes";
  truth(0.0, 5.0, 0.0, 0.0);
  estimate(0.0, 5.0, 0.0, 0.0);
  EXPECT_THAT(refusal(), HasSubstr("keyframes: /boxes is not in the recording"));
}

TEST_F(RecordedMotionTest, CountsWhatIsWrong) {
  for (int i = 0; i <= 100; ++i) truth(0.1 * i, i == 40 ? std::nan("") : 10.0, 0.0, 0.0);
  for (int i = 0; i < 10; ++i) estimate(0.1 * i, 10.0, 0.0, 0.0);
  estimate(0.35, 10.0, 0.0, 0.0);
  estimate(0.9, 10.0, 0.0, 0.0);
  estimate(20.0, 10.0, 0.0, 0.0);
  geometry_msgs::TwistWithCovarianceStamped unstamped;
  unstamped.header.frame_id = "base_link";
  bag_.write("/ego/twist", ros::Time(kStart + 5.0), unstamped);
  const MotionReport report = evaluate();
  EXPECT_EQ(figure(report, "estimate/messages"), 14);
  EXPECT_EQ(figure(report, "estimate/unordered"), 0);  // a bag has them in the order of recording
  EXPECT_EQ(figure(report, "estimate/repeated"), 1);
  EXPECT_EQ(figure(report, "estimate/zero_stamps"), 1);
  EXPECT_EQ(figure(report, "reference/not_finite"), 1);
  EXPECT_EQ(figure(report, "compared"), 12);
  EXPECT_EQ(figure(report, "outside"), 1);
}

TEST_F(RecordedMotionTest, UnorderedStampsAreSortedAndCounted) {
  for (int i = 0; i <= 100; ++i) truth(0.1 * i, 0.1 * i, 0.0, 0.0);
  for (const double time : {1.0, 3.0, 2.0, 4.0}) {
    geometry_msgs::TwistWithCovarianceStamped message;
    message.header.stamp = ros::Time(kStart + time);
    message.header.frame_id = "base_link";
    message.twist.twist.linear.x = time;
    bag_.write("/ego/twist", ros::Time(kStart + 5.0), message);
  }
  const MotionReport report = evaluate();
  EXPECT_EQ(figure(report, "estimate/unordered"), 1);
  EXPECT_NEAR(figure(report, "vx/mae"), 0.0, 1e-9);
}

TEST_F(RecordedMotionTest, MasksOfTheSameStamp) {
  const auto writeMask = [this](double time, const std::vector<std::uint8_t>& pixels) {
    sensor_msgs::Image image;
    image.width = image.height = 2;
    image.step = 2;
    image.encoding = "mono8";
    image.data = pixels;
    write("/dynamic/mask", time, image, "camera");
  };
  for (int i = 0; i <= 50; ++i) {
    truth(0.1 * i, 5.0, 0.0, 0.0);
    estimate(0.1 * i, 5.0, 0.0, 0.0);
  }
  writeMask(1.0, {255, 255, 0, 0});
  writeMask(2.0, {255, 255, 255, 255});  // no truth
  sensor_msgs::CompressedImage compressed;
  const cv::Mat actual = (cv::Mat_<std::uint8_t>(2, 2) << 255, 0, 255, 0);
  cv::imencode(".png", actual, compressed.data);
  write("/ground_truth/dynamic_mask/compressed", 1.0, compressed, "camera");
  const MotionReport report = evaluate();
  EXPECT_EQ(figure(report, "masks/frames"), 1);
  EXPECT_EQ(figure(report, "masks/without_truth"), 1);
  EXPECT_NEAR(figure(report, "masks/iou"), 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(figure(report, "masks/precision"), 0.5, 1e-9);
}

// To the north of the map at 10 m/s, with an odometry that calls it east, behind a car at 8 m/s; on the left
// a parked car, on the right a pedestrian. Boxes twice a second, tracks 30 ms after the second of three
// keyframes.
class RecordedObjectsTest : public RecordedMotionTest {
 protected:
  static constexpr double kStamp = 1.53;  // s

  RecordedObjectsTest() {
    for (int i = 0; i <= 30; ++i) {
      const double time = 0.1 * i;
      write("/truth", time, odometryOf(100.0, 10.0 * time, M_PI_2), "map");
      write("/odom", time, odometryOf(10.0 * time, 0.0, 0.0), "odom");
      estimate(time, 10.0, 0.0, 0.0);
    }
    transform("/tf_static", 0.0, "base_link", "radar", 3.0, 0.0);
  }

  void boxes() {
    for (const double time : {1.0, 1.5, 2.0}) {
      visualization_msgs::MarkerArray array;
      const auto add = [&](int id, double x, double y, const char* category, bool moves) {
        visualization_msgs::Marker& box = array.markers.emplace_back();
        box.header.stamp = ros::Time(kStart + time);
        box.header.frame_id = "map";
        box.id = id;
        box.type = visualization_msgs::Marker::CUBE;
        box.text = category;
        (moves ? box.color.r : box.color.b) = 0.9F;
        box.pose.position.x = x;
        box.pose.position.y = y;
        box.pose.orientation.w = box.pose.orientation.z = std::sqrt(0.5);
        box.scale.x = 4.0;
        box.scale.y = 2.0;
      };
      add(1, 100.0, 30.0 + 8.0 * time, "vehicle.car", true);
      add(2, 95.0, 40.0, "vehicle.car", false);
      add(3, 103.0, 20.0 + time, "human.pedestrian.adult", true);
      bag_.write("/ground_truth/boxes", ros::Time(kStart + time), array);
    }
  }

  void returns(const std::string& topic, double time, const std::vector<std::array<float, 3>>& points) {
    using sensor_msgs::PointField;
    sensor_msgs::PointCloud2 cloud;  // of points that nothing aligns, with x as another driver writes it
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(points.size());
    const auto addField = [&cloud](const char* name, std::uint8_t type, std::uint32_t offset) {
      cloud.fields.emplace_back();
      cloud.fields.back().name = name;
      cloud.fields.back().datatype = type;
      cloud.fields.back().offset = offset;
      cloud.fields.back().count = 1;
    };
    addField("x", PointField::FLOAT64, 1);
    addField("y", PointField::FLOAT32, 9);
    addField("z", PointField::FLOAT32, 13);
    addField("residual", PointField::FLOAT32, 17);
    cloud.point_step = 21;
    cloud.row_step = cloud.width * cloud.point_step;
    cloud.data.resize(cloud.row_step);
    std::uint8_t* to = cloud.data.data();
    for (const auto& [ahead, left, residual] : points) {
      const double x = ahead;
      std::memcpy(to + 1, &x, sizeof x);
      std::memcpy(to + 9, &left, sizeof left);
      std::memcpy(to + 17, &residual, sizeof residual);
      to += cloud.point_step;
    }
    write(topic, time, cloud, "radar");
  }

  /// @param shift  m, of the axes of the frame to the front
  void tracks(const std::string& frame, double shift) {
    MovingObjects message;
    const auto add = [&](double x, double y) {
      MovingObject& object = message.objects.emplace_back();
      object.id = message.objects.size();
      object.position.x = x - shift;
      object.position.y = y;
      object.velocity.x = 8.4;
      object.velocity.y = 0.3;
      object.velocity_covariance = {0.125, 0.0, 0.0, 0.125};
    };
    add(30.0 + 8.0 * kStamp - 1.5, 0.0);  // the rear of the car
    add(40.0, 5.0);                       // the parked car
    add(50.0, 10.0);                      // nothing
    add(-10.0, 0.0);                      // behind
    write("/dynamic/objects", kStamp, message, frame);
  }

  /// @param unmoving  pedestrians with a return that does not move
  void expectFigures(double unmoving) {
    const MotionReport report = evaluate();
    const std::vector<std::pair<std::string, double>> expected = {{"keyframes", 1},
                                                                  {"without_objects", 2},
                                                                  {"tracks", 3},
                                                                  {"true_tracks", 1},
                                                                  {"standing_tracks", 1},
                                                                  {"empty_tracks", 1},
                                                                  {"precision", 1.0 / 3.0},
                                                                  {"movers_vehicle", 1},
                                                                  {"movers_pedestrian", 1},
                                                                  {"recall_vehicle", 1.0},
                                                                  {"recall_pedestrian", 0.0},
                                                                  {"unseen_all", 0},
                                                                  {"unmoving_vehicle", 0},
                                                                  {"unmoving_pedestrian", unmoving},
                                                                  {"position_mae_all", 1.5},
                                                                  {"radial_mae_all", 0.4},
                                                                  {"velocity_mae_all", 0.5},
                                                                  {"velocity_nees_all", 2.0}};
    for (const auto& [key, value] : expected)
      EXPECT_NEAR(figure(report, "objects/" + key), value, 1e-6) << key;
    EXPECT_THAT(formatTable(report), HasSubstr("1 keyframes compared, 2 without objects"));
  }
};

TEST_F(RecordedObjectsTest, InTheFrameOfTheOdometry) {
  boxes();
  returns("/radar/dynamic", 1.4, {{24.2F, 0.F, -2.F}});  // the car
  returns("/radar/static", 1.4, {{4.4F, -3.F, 0.1F}});   // the pedestrian
  tracks("odom", 0.0);
  expectFigures(1);
  EXPECT_TRUE(doubts_.empty());
}

TEST_F(RecordedObjectsTest, InTheBaseFrameWithoutReturns) {
  boxes();
  tracks("base_link", 10.0 * kStamp);
  expectFigures(0);
  EXPECT_THAT(doubts_, ElementsAre(HasSubstr("without /radar/static")));
}

TEST_F(RecordedObjectsTest, WithoutBoxes) {
  tracks("odom", 0.0);
  const MotionReport report = evaluate();
  EXPECT_FALSE(report.objects);
  EXPECT_THAT(formatTable(report),
              HasSubstr("Objects: not compared: the recording has no /ground_truth/boxes\n"));
}

TEST_F(RecordedObjectsTest, NeedPosesInTheFrameOfTheBoxes) {
  boxes();
  tracks("odom", 0.0);
  options_.reference = "/odom";
  const MotionReport report = evaluate();
  EXPECT_FALSE(report.objects);
  EXPECT_THAT(formatTable(report), HasSubstr("/odom has no poses in 'map'"));
}

TEST_F(RecordedMotionTest, SaysWhichTopicsThereAre) {
  estimate(0.0, 5.0, 0.0, 0.0);
  write("/gnss", 0.0, odometryOf(0.0, 0.0, 0.0), "map");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("reference: /truth is not in the recording"),
                               HasSubstr("/gnss (nav_msgs/Odometry)"), HasSubstr("sensor_msgs/NavSatFix")));
}

TEST_F(RecordedMotionTest, SaysThatATopicDoesNotFit) {
  options_.twist = "/picture";
  write("/picture", 0.0, sensor_msgs::Image(), "camera");
  EXPECT_THAT(refusal(), HasSubstr("twist: /picture is of the type sensor_msgs/Image"));
}

TEST_F(RecordedMotionTest, RefusesTransformsThatAreNotThere) {
  options_.reference = "tf:map:base_link";
  transform("/tf_static", 0.0, "base_link", "gnss", 2.0, 0.0);
  estimate(0.0, 5.0, 0.0, 0.0);
  EXPECT_THAT(refusal(), HasSubstr("base_link -> gnss"));
}

TEST_F(RecordedMotionTest, RefusesTimesThatDoNotMeet) {
  for (int i = 0; i < 10; ++i) {
    truth(0.1 * i, 5.0, 0.0, 0.0);
    estimate(100.0 + 0.1 * i, 5.0, 0.0, 0.0);
  }
  EXPECT_THAT(refusal(), HasSubstr("no time in common"));
}

TEST_F(RecordedMotionTest, Tool) {
  for (int i = 0; i <= 50; ++i) {
    truth(0.1 * i, 5.0, 0.0, 0.0);
    estimate(0.1 * i, 5.5, 0.0, 0.0);
  }
  bag_.close();
  const std::string bag = (folder_.path() / "drive.bag").string(),
                    json = (folder_.path() / "r.json").string();
  const std::string tool = std::string(TOOL) + " ";
  EXPECT_EQ(test::runCommand(tool + bag + " --reference /truth --csv " + (folder_.path() / "r.csv").string())
                .exit_code,
            0);
  EXPECT_THAT(test::readFile(folder_.path() / "r.csv"), HasSubstr("vx/mae"));
  test::expectReportRepeatsRun(TOOL, bag + " --reference /truth");
  EXPECT_THAT(test::runCommand(tool + "--help").text,
              HasSubstr("Usage: evaluate_bag BAG... [--config FILE]... [OPTION]...\n"));
  test::expectOneLineRefusal(tool + "--reference /truth", "evaluate_bag", "--bags must be given");
  test::expectOneLineRefusal(tool + bag + " --reference /none", "evaluate_bag", "--reference");
  test::expectOneLineRefusal(tool + bag + " none.bag --reference /truth", "evaluate_bag", "none.bag");
}

}  // namespace
}  // namespace radar_dot::evaluation
