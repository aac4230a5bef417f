// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Decoding, flow, depth and overlay with images, clouds and depth whose results are known, and wrong ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "live_camera.h"
#include "live_graph.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

constexpr double kShift = LiveCamera::kShift;
// The return 12 m ahead of the base was seen 0.1 s before; the camera sits 1.7 m ahead of the base.
constexpr double kExpectedDepth = LiveCamera::kReturnAhead - VisionWorld::kSpeed * 0.1 - 1.7;  // m
using Frame = LiveCamera::Frame;
using Fault = LiveCamera::Fault;

class ImageInputs : public testing::Test {
 protected:
  void expectReported(const Fault& fault, const std::string& name, const std::string& words) {
    camera_.set(fault);
    EXPECT_TRUE(diagnostics_.says(name, DiagnosticStatus::WARN, words));
    camera_.set({});
    EXPECT_TRUE(diagnostics_.says(name, DiagnosticStatus::OK, ""));
  }
  /// Median horizontal flow in px of the image from one image to the next, whichever images a pair is of. The
  /// pairs over which the texture starts again show as outliers that the median over messages leaves out.
  static double medianFlow(const Recorder<Flow>& flows, const Recorder<Image>& images) {
    std::map<ros::Time, int> numbers;
    for (const auto& image : images.messages())
      numbers.emplace(image->header.stamp, static_cast<int>(numbers.size()));
    std::vector<double> medians;
    for (const auto& flow : flows.messages()) {
      const auto first = numbers.find(flow->header.stamp), second = numbers.find(flow->second_stamp);
      if (first == numbers.end() || second == numbers.end()) continue;
      const cv::Mat field = matOf(flow->flow, CV_32FC2);
      std::vector<double> values;
      for (int row = 20; row < field.rows - 20; ++row)
        for (int column = 40; column < field.cols - 40; ++column)
          values.push_back(static_cast<double>(field.at<cv::Vec2f>(row, column)[0]));
      medians.push_back(medianOf(values) * flow->image_width / field.cols / (second->second - first->second));
    }
    return medianOf(medians);
  }
  static double medianOf(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
  static float depthAt(const Image& message, int row, int column) {
    return matOf(message, CV_32FC1).at<float>(row, column);
  }

  ros::NodeHandle handle_;
  Diagnostics diagnostics_{handle_};
  LiveCamera camera_{handle_};
};

TEST_F(ImageInputs, FlowRunsForwardOnRawImages) {
  const Recorder<Image> images(handle_, "image");
  ASSERT_TRUE(images.grows());
  const Recorder<Flow> flows(handle_, "raw_flow/flow");
  ASSERT_TRUE(flows.grows(9));
  EXPECT_NEAR(medianFlow(flows, images), kShift, 0.5);
  const Flow& flow = *flows.latest();
  EXPECT_EQ(flow.flow.width, 160U);
  EXPECT_EQ(flow.image_width, 320U);
  EXPECT_LT(flow.header.stamp, flow.second_stamp);
}

TEST_F(ImageInputs, FlowRunsBackwardOnCompressedImagesFartherApart) {
  const Recorder<Image> images(handle_, "image");
  ASSERT_TRUE(images.grows());
  const Recorder<Flow> flows(handle_, "backward_flow/flow");
  ASSERT_TRUE(flows.grows(9));
  EXPECT_NEAR(medianFlow(flows, images), kShift, 0.5);
  const Flow& flow = *flows.latest();
  EXPECT_EQ(flow.flow.width, 320U);
  EXPECT_EQ(flow.valid.encoding, "mono8");
  EXPECT_GT(flow.header.stamp, flow.second_stamp);
  EXPECT_TRUE(waitUntil([&] {
    return std::abs((flows.latest()->header.stamp - flows.latest()->second_stamp).toSec() - 0.2) < 0.05;
  }));
}

TEST_F(ImageInputs, FlowThatStartsFromTheExpectedOneWaitsForIt) {
  const Recorder<Flow> flows(handle_, "expected_flow/flow");
  ASSERT_TRUE(flows.grows());
  // Without depth it goes on without an initial flow, and says so.
  expectReported([](Frame& frame) { frame.depth.header.stamp += ros::Duration(0.001); },
                 "expected_flow: flow", "without an initial flow");
}

TEST_F(ImageInputs, WrongImagesAreRefused) {
  const Recorder<Flow> raw(handle_, "raw_flow/flow");
  const Recorder<Flow> compressed(handle_, "backward_flow/flow");
  ASSERT_TRUE(raw.grows());
  expectReported([](Frame& frame) { frame.image.encoding = "purple8"; }, "raw_flow: input image", "purple8");
  expectReported([](Frame& frame) { frame.image.data.resize(10); }, "raw_flow: input image", "image");
  expectReported([](Frame& frame) { frame.image.width = frame.image.height = 0; }, "raw_flow: input image",
                 "empty");
  expectReported(
      [](Frame& frame) { frame.compressed.data.resize(frame.compressed.data.size() > 30 ? 30 : 0); },
      "backward_flow: input image", "decoded");
  EXPECT_TRUE(raw.grows());
  EXPECT_TRUE(compressed.grows());
}

TEST_F(ImageInputs, ImagesMayChangeTheirSize) {
  const Recorder<Flow> raw(handle_, "raw_flow/flow");
  ASSERT_TRUE(raw.grows());
  camera_.set([](Frame& frame) {
    frame.image = imageOf(frame.image.header.stamp, "mono8", cv::Mat(360, 640, CV_8UC1, cv::Scalar(90)));
  });
  EXPECT_TRUE(waitUntil([&] { return raw.latest()->image_width == 640U; }));
  camera_.set({});
  EXPECT_TRUE(waitUntil([&] { return raw.latest()->image_width == 320U; }));
}

TEST_F(ImageInputs, DecodedImagesAreTheOriginals) {
  const Recorder<Image> decoded(handle_, "decode/image");
  const Recorder<Image> original(handle_, "image");
  boost::shared_ptr<const Image> image, sent;
  ASSERT_TRUE(waitUntil([&] {
    for (const auto& candidate : original.messages())
      for (const auto& made : decoded.messages())
        if (candidate->header.stamp == made->header.stamp) image = made, sent = candidate;
    return image != nullptr;
  }));
  EXPECT_EQ(image->encoding, "bgr8");
  cv::Mat colour;
  cv::cvtColor(matOf(*sent, CV_8UC1), colour, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(colour, matOf(*image, CV_8UC3), cv::NORM_INF), 0.0);
}

// Where the machine is busy a cloud may come after its image: an older one takes its place in that depth.
TEST_F(ImageInputs, RadarDepthFollowsTheVehicle) {
  const Recorder<Image> depths(handle_, "ground_depth/depth");
  ASSERT_TRUE(depths.grows());
  ASSERT_EQ(depths.latest()->encoding, "32FC1");
  ASSERT_EQ(depths.latest()->width, 160U);
  boost::shared_ptr<const Image> latest;
  EXPECT_TRUE(waitUntil([&] {
    latest = depths.latest();
    return std::abs(depthAt(*latest, 50, 80) - kExpectedDepth) < 0.1;  // just below the horizon
  }));
  const Image& depth = *latest;
  // The ground 0.15 m below the lower border of the image's middle column: z f / (v - c) = height.
  const double ground = 1.5 * 100.0 / (89.0 - 44.5);
  EXPECT_NEAR(depthAt(depth, 89, 20), ground, 0.1);
  EXPECT_TRUE(std::isnan(depthAt(depth, 5, 5)));  // the sky
}

TEST_F(ImageInputs, LidarDepthFollowsTheVehicle) {
  const Recorder<Image> depths(handle_, "lidar_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_TRUE(waitUntil([&] {
    double largest = 0.0;
    cv::Mat depth = matOf(*depths.latest(), CV_32FC1);
    cv::patchNaNs(depth, 0.0);
    cv::minMaxLoc(depth, nullptr, &largest);
    return std::abs(largest - kExpectedDepth) < 0.1;
  }));
}

TEST_F(ImageInputs, SomebodyElsesDepthIsCleaned) {
  const Recorder<Image> depths(handle_, "topic_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_FLOAT_EQ(depthAt(*depths.latest(), 40, 40), 7.5F);
  EXPECT_EQ(depths.latest()->width, 160U);
  camera_.set([](Frame& frame) {
    frame.depth = imageOf(frame.depth.header.stamp, "32FC1",
                          cv::Mat(180, 320, CV_32FC1, cv::Scalar(std::numeric_limits<double>::infinity())));
  });
  EXPECT_TRUE(waitUntil([&] { return std::isnan(depthAt(*depths.latest(), 40, 40)); }));
  expectReported([](Frame& frame) { frame.depth.encoding = "bgr8"; }, "topic_depth: input depth/input",
                 "bgr8");
}

// With the stamp and the grid of the depth, and known where that is.
TEST_F(ImageInputs, DepthSaysHowUncertainItIs) {
  // Waits for a pair whose uncertainty is as it should be; all pairs must fit.
  const auto expect = [this](const std::string& name, const std::function<bool(const cv::Mat&)>& is_right) {
    const Recorder<Image> depths(handle_, name + "/depth");
    const Recorder<Image> stds(handle_, name + "/uncertainty");
    EXPECT_TRUE(waitUntil([&] {
      for (const auto& depth : depths.messages()) {
        for (const auto& std : stds.messages()) {
          if (std->header.stamp != depth->header.stamp) continue;
          EXPECT_EQ(std->encoding, "32FC1") << name;
          EXPECT_EQ(std->header.frame_id, depth->header.frame_id) << name;
          const cv::Mat known = matOf(*depth, CV_32FC1), declared = matOf(*std, CV_32FC1);
          EXPECT_EQ(known.size(), declared.size()) << name;
          EXPECT_EQ(cv::countNonZero((known == known) != (declared == declared)), 0) << name;
          if (is_right(declared)) return true;
        }
      }
      return false;
    })) << name;
  };
  expect("topic_depth", [](const cv::Mat& stds) { return stds.at<float>(40, 40) == 0.125F; });
  expect("ground_depth", [](const cv::Mat& stds) {
    const float ground = stds.at<float>(89, 20);  // that is not flat
    return stds.at<float>(50, 80) == 0.25F /* the column of the return */ && ground > 0.1F && ground < 0.15F;
  });
  expect("lidar_depth", [](const cv::Mat& stds) {
    double smallest = 0.0;
    cv::minMaxLoc(stds, &smallest);  // leaves NaN out
    return static_cast<float>(smallest) == 0.03125F;
  });
}

// Nobody looks at the depth itself.
TEST_F(ImageInputs, UncertaintyAloneIsReasonEnough) {
  const Recorder<Image> stds(handle_, "misspelt_depth/uncertainty");
  EXPECT_TRUE(stds.grows());
}

TEST_F(ImageInputs, AMisspeltBackendIsReplaced) {
  EXPECT_TRUE(diagnostics_.says("misspelt_depth: depth", DiagnosticStatus::ERROR, "lydar"));
  const Recorder<Image> depths(handle_, "misspelt_depth/depth");
  EXPECT_TRUE(depths.grows());
}

TEST_F(ImageInputs, BackendsAreExchangedLive) {
  const Recorder<Image> depths(handle_, "topic_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_EQ(reconfigure("topic_depth", {{"depth_backend", "radar_ground"}}).at("depth_backend"),
            "radar_ground");
  EXPECT_TRUE(waitUntil([&] { return std::abs(depthAt(*depths.latest(), 40, 40) - 7.5F) > 0.5F; }));
  EXPECT_EQ(reconfigure("topic_depth", {{"depth_backend", "topic"}}).at("depth_backend"), "topic");
  EXPECT_TRUE(waitUntil([&] { return std::abs(depthAt(*depths.latest(), 40, 40) - 7.5F) < 1e-3F; }));
}

TEST_F(ImageInputs, PicturesAreDrawnWhileTheyHaveSubscribers) {
  EXPECT_TRUE(diagnostics_.says("overlay: overlay", DiagnosticStatus::OK, "idle: no subscribers"));
  const Recorder<Image> masks(handle_, "overlay/mask");
  const Recorder<Image> panels(handle_, "overlay/six_panel");
  ASSERT_TRUE(masks.grows());
  ASSERT_TRUE(panels.grows());
  EXPECT_EQ(masks.latest()->width, 320U);
  EXPECT_EQ(panels.latest()->encoding, "bgr8");
  EXPECT_EQ(panels.latest()->width, 3U * 640U);
  // A part that does not come is missing in the picture, not the picture.
  camera_.set([](Frame& frame) { frame.depth.header.stamp += ros::Duration(0.001); });
  EXPECT_TRUE(diagnostics_.says("overlay: overlay", DiagnosticStatus::WARN, "/topic_depth/depth"));
  EXPECT_TRUE(panels.grows());
}

}  // namespace
}  // namespace radar_dot::test
