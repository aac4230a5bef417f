// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Five live radars and masks of a camera: returns within the mask count as dynamic, and no mask costs an
// estimate.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "live_graph.h"
#include "radar_dot/EgoStatus.h"
#include "synthetic_bag.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

constexpr double kPatience = 10.0;  // s; machines are slow at times
constexpr double kSpeed = 8.0;      // m/s

Image maskOf(const ros::Time& stamp, int value) {
  return imageOf(stamp, "mono8",
                 cv::Mat(VisionWorld::kHeight, VisionWorld::kWidth, CV_8UC1, cv::Scalar(value)));
}

/// Publishes scans at 13 Hz, and before each round of them a mask.
class LiveVehicle {
 public:
  using MaskSource = std::function<Image(const ros::Time&)>;

  explicit LiveVehicle(ros::NodeHandle& handle)
      : mask_(handle.advertise<Image>("dynamic/mask", 5)),
        camera_(handle.advertise<sensor_msgs::CameraInfo>("camera/camera_info", 5, true)) {
    std::vector<geometry_msgs::TransformStamped> mounts = {VisionWorld::mount()};
    for (const SyntheticRadar& radar : syntheticRadars()) {
      mounts.push_back(radar.mount);
      mounts.back().header.stamp = ros::Time::now();
      radars_.push_back(handle.advertise<sensor_msgs::PointCloud2>(radar.name, 5));
    }
    broadcaster_.sendTransform(mounts);
    camera_.publish(VisionWorld::cameraInfo(ros::Time::now()));
    thread_ = std::thread([this] { run(); });
  }
  ~LiveVehicle() {
    stop_ = true;
    thread_.join();
  }
  void set(const MaskSource& source) {
    const std::lock_guard<std::mutex> lock(mutex_);
    source_ = source;
  }

 private:
  void run() {
    TrueState state;
    state.speed = kSpeed;
    unsigned seed = 1;
    ros::WallRate rate(13.0);
    while (!stop_ && ros::ok()) {
      const ros::Time now = ros::Time::now();
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (source_) mask_.publish(source_(now - ros::Duration(0.05)));
      }
      ros::WallDuration(0.01).sleep();  // so that the mask is there first
      for (std::size_t radar = 0; radar < radars_.size(); ++radar)
        radars_[radar].publish(
            syntheticScan(state, radar, now + ros::Duration(0.001 * static_cast<double>(radar)), seed++));
      rate.sleep();
    }
  }

  ros::Publisher mask_, camera_;
  std::vector<ros::Publisher> radars_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::mutex mutex_;
  MaskSource source_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

class MaskLoop : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(waitUntil([&] { return twists_.connected() && statuses_.connected(); }, kPatience));
  }
  /// Mean number of dynamic returns of the estimates to come; -1 when none come.
  double meanDynamicCount() {
    const std::size_t settled = statuses_.count() + 5;
    if (!waitUntil([&] { return statuses_.count() >= settled + 10; }, kPatience)) return -1.0;
    const auto all = statuses_.messages();
    double sum = 0.0;
    for (std::size_t i = settled; i < all.size(); ++i) sum += all[i]->dynamic_count;
    return sum / static_cast<double>(all.size() - settled);
  }
  void expectTwistsGoOn() {
    const std::size_t before = twists_.count();
    ASSERT_TRUE(waitUntil([&] { return twists_.count() >= before + 5; }, kPatience));
    EXPECT_NEAR(twists_.messages().back()->twist.twist.linear.x, kSpeed, 0.1);
  }
  bool reported(const std::string& name, int level, const std::string& words) {
    return waitUntil(
        [&] {
          const Diagnostics::Status status = diagnostics_.latest(name);
          return status.level >= level && status.message.find(words) != std::string::npos;
        },
        kPatience);
  }

  ros::NodeHandle handle_;
  Recorder<geometry_msgs::TwistWithCovarianceStamped> twists_{handle_, "ego/twist"};
  Recorder<EgoStatus> statuses_{handle_, "ego/status"};
  Diagnostics diagnostics_{handle_};
  LiveVehicle vehicle_{handle_};
};

TEST_F(MaskLoop, ReturnsInTheMaskAreDynamic) {
  vehicle_.set([](const ros::Time& stamp) { return maskOf(stamp, 0); });
  const double nothing_marked = meanDynamicCount();
  ASSERT_GT(nothing_marked, 0.0);
  vehicle_.set([](const ros::Time& stamp) { return maskOf(stamp, 255); });
  const double all_marked = meanDynamicCount();
  // The camera sees about half of what the front radars see, four fifths of it static.
  EXPECT_GT(all_marked, nothing_marked + 10.0);
  expectTwistsGoOn();
}

TEST_F(MaskLoop, MasksThatCannotBeUsedCostNoEstimate) {
  vehicle_.set([](const ros::Time& stamp) { return VisionWorld::image(stamp, 0.0, "bgr8"); });
  EXPECT_TRUE(reported("ego_velocity: input dynamic/mask", DiagnosticStatus::ERROR, "not mono8"));
  expectTwistsGoOn();
  vehicle_.set([](const ros::Time& stamp) {
    return imageOf(stamp, "mono8", cv::Mat(100, 100, CV_8UC1, cv::Scalar(255)));
  });
  EXPECT_TRUE(reported("ego_velocity: estimator", DiagnosticStatus::WARN, "shape"))
      << diagnostics_.latest("ego_velocity: estimator").message;
  expectTwistsGoOn();
}

TEST_F(MaskLoop, OldMasksSayNothing) {
  vehicle_.set([](const ros::Time& stamp) { return maskOf(stamp, 0); });
  const double nothing_marked = meanDynamicCount();
  vehicle_.set([](const ros::Time& stamp) { return maskOf(stamp - ros::Duration(3.0), 255); });
  EXPECT_TRUE(reported("ego_velocity: estimator", DiagnosticStatus::WARN, "mask_max_age"))
      << diagnostics_.latest("ego_velocity: estimator").message;
  EXPECT_LT(meanDynamicCount(), nothing_marked + 5.0);
  expectTwistsGoOn();
}

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "mask_loop_test");
  const ros::NodeHandle keeper;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
