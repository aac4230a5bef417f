// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Five live radars and masks of a camera: returns within the mask count as dynamic, and no mask costs an
// estimate.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <functional>

#include "live_radars.h"
#include "radar_dot/EgoStatus.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

Image maskOf(const ros::Time& stamp, int value) {
  return imageOf(stamp, "mono8",
                 cv::Mat(VisionWorld::kHeight, VisionWorld::kWidth, CV_8UC1, cv::Scalar(value)));
}

class MaskLoop : public testing::Test {
 protected:
  using MaskSource = std::function<Image(const ros::Time&)>;

  void SetUp() override {
    broadcaster_.sendTransform(VisionWorld::mount());
    camera_.publish(VisionWorld::cameraInfo(ros::Time::now()));
    ASSERT_TRUE(twists_.grows());
  }
  /// A mask before each round of scans.
  void send(const MaskSource& source) {
    radars_.set(LiveRadars::kFront, [this, source](const sensor_msgs::PointCloud2& scan) {
      mask_.publish(source(scan.header.stamp - ros::Duration(0.05)));
    });
  }
  /// Mean number of dynamic returns of the estimates to come, of all radars; -1 when none come.
  double meanDynamicCount() {
    const std::size_t settled = statuses_.count() + 5;
    if (!statuses_.grows(15)) return -1.0;
    const auto all = statuses_.messages();
    double sum = 0.0, complete = 0.0;
    for (std::size_t i = settled; i < all.size(); ++i) {
      if (all[i]->radar_count < LiveRadars::kRadars) continue;  // a busy machine sends some too late
      sum += all[i]->dynamic_count;
      complete += 1.0;
    }
    return complete > 0.0 ? sum / complete : -1.0;
  }
  void expectTwistsGoOn() {
    ASSERT_TRUE(twists_.grows(5));
    EXPECT_NEAR(twists_.latest()->twist.twist.linear.x, LiveRadars::kSpeed, 0.1);
  }

  ros::NodeHandle handle_;
  Recorder<geometry_msgs::TwistWithCovarianceStamped> twists_{handle_, "ego/twist"};
  Recorder<EgoStatus> statuses_{handle_, "ego/status"};
  Diagnostics diagnostics_{handle_};
  ros::Publisher mask_ = handle_.advertise<Image>("dynamic/mask", 5);
  ros::Publisher camera_ = handle_.advertise<sensor_msgs::CameraInfo>("camera/camera_info", 5, true);
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  LiveRadars radars_{handle_};
};

TEST_F(MaskLoop, ReturnsInTheMaskAreDynamic) {
  send([](const ros::Time& stamp) { return maskOf(stamp, 0); });
  const double nothing_marked = meanDynamicCount();
  ASSERT_GT(nothing_marked, 0.0);
  send([](const ros::Time& stamp) { return maskOf(stamp, 255); });
  const double all_marked = meanDynamicCount();
  // The camera sees about half of what the front radars see, four fifths of it static.
  EXPECT_GT(all_marked, nothing_marked + 10.0);
  expectTwistsGoOn();
}

TEST_F(MaskLoop, MasksThatCannotBeUsedCostNoEstimate) {
  send([](const ros::Time& stamp) { return VisionWorld::image(stamp, 0.0, "bgr8"); });
  EXPECT_TRUE(diagnostics_.says("ego_velocity: input dynamic/mask", DiagnosticStatus::ERROR, "not mono8"));
  expectTwistsGoOn();
  send([](const ros::Time& stamp) {
    return imageOf(stamp, "mono8", cv::Mat(100, 100, CV_8UC1, cv::Scalar(255)));
  });
  EXPECT_TRUE(diagnostics_.says("ego_velocity: estimator", DiagnosticStatus::WARN, "shape"));
  expectTwistsGoOn();
}

TEST_F(MaskLoop, OldMasksSayNothing) {
  send([](const ros::Time& stamp) { return maskOf(stamp, 0); });
  const double nothing_marked = meanDynamicCount();
  send([](const ros::Time& stamp) { return maskOf(stamp - ros::Duration(3.0), 255); });
  EXPECT_TRUE(diagnostics_.says("ego_velocity: estimator", DiagnosticStatus::WARN, "mask_max_age"));
  EXPECT_LT(meanDynamicCount(), nothing_marked + 5.0) << "before: " << nothing_marked;
  expectTwistsGoOn();
}

}  // namespace
}  // namespace radar_dot::test
