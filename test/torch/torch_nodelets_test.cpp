// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The live nodelets with networks whose results are known, and with files that are none.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "fixtures/files.h"
#include "nodelets/live_camera.h"
#include "nodelets/live_graph.h"
#include "nodelets/vision_world.h"
#include "torch_script_file.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

class TorchNodelets : public testing::Test {
 protected:
  std::string network(const std::string& forward) const {
    const std::filesystem::path file = folder_.path() / ("network" + std::to_string(networks_++) + ".pt");
    writeTorchScript(file, forward);
    return file.string();
  }
  static cv::Vec2f middleOf(const Flow& flow) {
    const cv::Mat field = matOf(flow.flow, CV_32FC2);
    return field.at<cv::Vec2f>(field.rows / 2, field.cols / 2);
  }

  TemporaryFolder folder_;
  mutable int networks_ = 0;
  ros::NodeHandle handle_;
  Diagnostics diagnostics_{handle_};
  LiveCamera camera_{handle_};
};

TEST_F(TorchNodelets, FlowComesFromTheNetwork) {
  const Recorder<Flow> flows(handle_, "learned_flow/flow");
  const std::map<std::string, std::string> in_use =
      reconfigure("learned_flow",
                  {{"flow_backend", "torch"}, {"flow_model", network(networks::constantFlow(24.0, -4.6))}});
  EXPECT_EQ(in_use.at("flow_backend"), "torch");
  // 320 x 184 px of the network are 160 x 90 px of the grid.
  EXPECT_TRUE(waitUntil([&] {
    if (flows.count() == 0) return false;
    const cv::Vec2f flow = middleOf(*flows.latest());
    return std::abs(flow[0] - 12.0F) < 1e-3F && std::abs(flow[1] + 2.25F) < 1e-3F;
  }));
  EXPECT_EQ(flows.latest()->flow.width, 160U);
  EXPECT_EQ(flows.latest()->image_width, 320U);
}

TEST_F(TorchNodelets, AWrongNetworkLeavesTheOneInUse) {
  const Recorder<Flow> flows(handle_, "learned_flow/flow");
  const std::string good = network(networks::constantFlow(24.0, 0.0));
  reconfigure("learned_flow", {{"flow_backend", "torch"}, {"flow_model", good}});
  EXPECT_TRUE(
      reconfigure("learned_flow", {{"flow_model", network("def forward(self, image):\n    return image\n")}})
          .empty());
  EXPECT_EQ(reconfigure("learned_flow", {}).at("flow_model"), good);
  EXPECT_TRUE(flows.grows());
  EXPECT_NEAR(middleOf(*flows.latest())[0], 12.0F, 1e-3F);
}

TEST_F(TorchNodelets, AChangeElsewhereDoesNotLoadTheNetworkAgain) {
  const std::string file = network(networks::constantFlow(24.0, 0.0));
  ASSERT_FALSE(reconfigure("learned_flow", {{"flow_backend", "torch"}, {"flow_model", file}}).empty());
  std::filesystem::remove(file);
  EXPECT_EQ(reconfigure("learned_flow", {{"direction", "backward"}}).at("direction"), "backward");
  EXPECT_EQ(reconfigure("learned_flow", {{"direction", "forward"}}).at("direction"), "forward");
  EXPECT_TRUE(reconfigure("learned_flow", {{"preset", "fast"}}).empty()) << "the file is not there any more";
  EXPECT_EQ(reconfigure("learned_flow", {}).at("preset"), "medium");
}

TEST_F(TorchNodelets, DepthOfTheRadarComesThroughTheNetwork) {
  const Recorder<Image> depths(handle_, "learned_depth/depth");
  reconfigure("learned_depth",
              {{"depth_backend", "torch"}, {"depth_model", network(networks::depthOfFarthestReturn())}});
  // The return 12 m ahead of the base was seen 0.1 s before; the camera sits 1.7 m ahead of the base.
  const float expected = LiveCamera::kReturnAhead - static_cast<float>(VisionWorld::kSpeed * 0.1) - 1.7F;
  EXPECT_TRUE(waitUntil([&] {
    if (depths.count() == 0) return false;
    const cv::Mat depth = matOf(*depths.latest(), CV_32FC1);
    return std::abs(depth.at<float>(60, 80) - expected) < 0.1F;
  }));
  EXPECT_EQ(depths.latest()->width, 160U);
}

TEST_F(TorchNodelets, DepthOfTheImageComesThroughTheNetwork) {
  const Recorder<Image> depths(handle_, "learned_depth/depth");
  reconfigure("learned_depth",
              {{"depth_backend", "torch"}, {"depth_model", network(networks::depthOfRed())}});
  camera_.set([](LiveCamera::Frame& frame) {
    frame.image = imageOf(frame.image.header.stamp, "mono8",
                          cv::Mat(VisionWorld::kHeight, VisionWorld::kWidth, CV_8UC1, cv::Scalar(55)));
  });
  EXPECT_TRUE(waitUntil([&] {
    return depths.count() > 0 &&
           std::abs(matOf(*depths.latest(), CV_32FC1).at<float>(60, 20) - 55.0F) < 0.01F;
  }));
  EXPECT_TRUE(std::isnan(matOf(*depths.latest(), CV_32FC1).at<float>(0, 20)));  // cut rows
}

TEST_F(TorchNodelets, ALostNetworkIsReportedAndReplaced) {
  EXPECT_TRUE(diagnostics_.says("lost_flow: flow", DiagnosticStatus::ERROR, "/nowhere/network.pt"));
  const Recorder<Flow> flows(handle_, "lost_flow/flow");
  EXPECT_TRUE(flows.grows());
}

}  // namespace
}  // namespace radar_dot::test
