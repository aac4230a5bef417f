// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/object_regions.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "fixtures/refusal.h"
#include "nodelets/vision_world.h"

namespace radar_dot {
namespace {

using test::expectRefusal;
using test::imageOf;
using test::VisionWorld;

const ros::Time kStamp(100.0);

/// The patch of the world, marked in a mask of the size of the images.
MaskMessages messagesAt(double second) {
  cv::Mat mask = cv::Mat::zeros(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_8UC1);
  mask(VisionWorld::patch()) = 255;
  cv::resize(mask, mask, {VisionWorld::kWidth, VisionWorld::kHeight}, 0.0, 0.0, cv::INTER_NEAREST);
  auto flow = boost::make_shared<Flow>(VisionWorld::flow(kStamp, ros::Time(second)));
  // Beside the patch the world is static.
  cv::Mat expected = test::matOf(flow->flow, CV_32FC2).clone();
  expected(VisionWorld::patch()) -= cv::Scalar(80.0 * (second - kStamp.toSec()), 0.0);
  MaskMessages messages;
  messages.mask = boost::make_shared<sensor_msgs::Image>(imageOf(kStamp, "mono8", mask));
  messages.depth = boost::make_shared<sensor_msgs::Image>(VisionWorld::depth(kStamp));
  messages.flow = flow;
  messages.expected_flow = boost::make_shared<sensor_msgs::Image>(imageOf(kStamp, "32FC2", expected));
  return messages;
}

std::vector<MaskRegion> regionsOf(const MaskMessages& messages) {
  return radar_dot::regionsOf(messages, VisionWorld::cameraInfo(kStamp), VisionWorld::T_base_from_camera(),
                              {});
}

// 80 px of the grid in a second, at 20 m and with a focal length of 100 px: 16 m/s to the right.
TEST(ObjectRegions, BoxesAreThoseOfTheImageAndVelocitiesThoseOfTheWorld) {
  for (const double second : {100.1, 99.9}) {
    const std::vector<MaskRegion> regions = regionsOf(messagesAt(second));
    ASSERT_EQ(regions.size(), 1U) << second;
    EXPECT_EQ(regions[0].box.x, 180);
    EXPECT_EQ(regions[0].box.y, 60);
    EXPECT_EQ(regions[0].box.width, 48);
    EXPECT_EQ(regions[0].box.height, 40);
    EXPECT_EQ(regions[0].pixel_count, 48U * 40U);
    EXPECT_NEAR(regions[0].position.x(), 21.7, 1e-4);
    EXPECT_NEAR(regions[0].position.y(), -4.4, 0.11) << "the median column is 101 or 102";
    EXPECT_NEAR(regions[0].lateral.value, 16.0, 0.01) << "whichever image is first";
    EXPECT_NEAR(regions[0].lateral.row.y(), -1.0, 1e-9);
  }
}

TEST(ObjectRegions, WhatDoesNotFitIsRefused) {
  const auto expectRefused = [](sensor_msgs::ImageConstPtr MaskMessages::*image, const std::string& encoding,
                                const cv::Mat& pixels, const std::string& part) {
    MaskMessages messages = messagesAt(100.1);
    messages.*image = boost::make_shared<sensor_msgs::Image>(imageOf(kStamp, encoding, pixels));
    expectRefusal([&] { regionsOf(messages); }, {part});
  };
  expectRefused(&MaskMessages::mask, "mono8", cv::Mat::zeros(100, 100, CV_8UC1), "mask of 100 x 100 px");
  expectRefused(&MaskMessages::depth, "32FC1", cv::Mat::zeros(100, 100, CV_32FC1), "depth of 100 x 100 px");
  expectRefused(&MaskMessages::expected_flow, "32FC2", cv::Mat::zeros(45, 80, CV_32FC2),
                "expected flow of 80 x 45 px");
  expectRefused(&MaskMessages::mask, "bgr8", cv::Mat::zeros(90, 160, CV_8UC3), "mono8");
  sensor_msgs::CameraInfo camera = VisionWorld::cameraInfo(kStamp);
  camera.height = 320;
  expectRefusal(
      [&] { radar_dot::regionsOf(messagesAt(100.1), camera, VisionWorld::T_base_from_camera(), {}); },
      {"camera_info"});
}

TEST(MaskMatcher, AMaskWaitsForWhatHasItsStamp) {
  const MaskMessages messages = messagesAt(100.1);
  MaskMatcher matcher;
  std::string missing;
  constexpr double kPatient = 100.0;  // s
  matcher.addMask(messages.mask, {});
  matcher.addDepth(messages.depth);
  matcher.addFlow(messages.flow);
  EXPECT_FALSE(matcher.take(kPatient, {}, missing));
  EXPECT_TRUE(missing.empty());
  matcher.addExpectedFlow(messages.expected_flow);
  const std::optional<MaskMessages> found = matcher.take(kPatient, {}, missing);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->flow, messages.flow);
  EXPECT_EQ(found->depth, messages.depth);
  EXPECT_FALSE(matcher.take(kPatient, {}, missing)) << "a mask is used once";
}

TEST(MaskMatcher, WhatNeverComesIsNamed) {
  const MaskMessages messages = messagesAt(100.1);
  MaskMatcher matcher;
  std::string missing;
  matcher.addMask(messages.mask, {});
  matcher.addDepth(messages.depth);
  EXPECT_FALSE(matcher.take(0.0, {}, missing));
  EXPECT_EQ(missing, "no flow with the stamp of the mask");
  matcher.addMask(messages.mask, {});
  matcher.clear();
  missing.clear();
  EXPECT_FALSE(matcher.take(0.0, {}, missing));
  EXPECT_TRUE(missing.empty());
}

}  // namespace
}  // namespace radar_dot
