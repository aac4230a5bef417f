// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The live nodelets with networks whose results are known, and with files that are none.
#include <dynamic_reconfigure/Reconfigure.h>
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

constexpr double kPatience = 15.0;  // s; machines are slow at times

class TorchNodelets : public testing::Test {
 protected:
  std::string network(const std::string& forward) const {
    const std::filesystem::path file = folder_.path() / ("network" + std::to_string(networks_++) + ".pt");
    writeTorchScript(file, forward);
    return file.string();
  }
  /// Sets text parameters of a nodelet. @return those in use afterwards; none: rejected
  static std::map<std::string, std::string> set(const std::string& nodelet,
                                                const std::map<std::string, std::string>& values) {
    dynamic_reconfigure::Reconfigure call;
    for (const auto& [name, value] : values) {
      dynamic_reconfigure::StrParameter parameter;
      parameter.name = name;
      parameter.value = value;
      call.request.config.strs.push_back(parameter);
    }
    EXPECT_TRUE(ros::service::waitForService(nodelet + "/set_parameters", ros::Duration(kPatience)));
    std::map<std::string, std::string> in_use;
    if (!ros::service::call(nodelet + "/set_parameters", call)) return in_use;
    for (const auto& parameter : call.response.config.strs) in_use[parameter.name] = parameter.value;
    return in_use;
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
      set("learned_flow",
          {{"flow_backend", "torch"}, {"flow_model", network(networks::constantFlow(24.0, -4.6))}});
  EXPECT_EQ(in_use.at("flow_backend"), "torch");
  // 320 x 184 px of the network are 160 x 90 px of the grid.
  EXPECT_TRUE(waitUntil(
      [&] {
        if (flows.count() == 0) return false;
        const cv::Vec2f flow = middleOf(*flows.messages().back());
        return std::abs(flow[0] - 12.0F) < 1e-3F && std::abs(flow[1] + 2.25F) < 1e-3F;
      },
      kPatience));
  EXPECT_EQ(flows.messages().back()->flow.width, 160U);
  EXPECT_EQ(flows.messages().back()->image_width, 320U);
}

TEST_F(TorchNodelets, AWrongNetworkLeavesTheOneInUse) {
  const Recorder<Flow> flows(handle_, "learned_flow/flow");
  const std::string good = network(networks::constantFlow(24.0, 0.0));
  set("learned_flow", {{"flow_backend", "torch"}, {"flow_model", good}});
  EXPECT_TRUE(set("learned_flow", {{"flow_model", network("def forward(self, image):\n    return image\n")}})
                  .empty());
  EXPECT_EQ(set("learned_flow", {}).at("flow_model"), good);
  const std::size_t before = flows.count();
  EXPECT_TRUE(waitUntil([&] { return flows.count() >= before + 3; }, kPatience));
  EXPECT_NEAR(middleOf(*flows.messages().back())[0], 12.0F, 1e-3F);
}

TEST_F(TorchNodelets, AChangeElsewhereDoesNotLoadTheNetworkAgain) {
  const std::string file = network(networks::constantFlow(24.0, 0.0));
  ASSERT_FALSE(set("learned_flow", {{"flow_backend", "torch"}, {"flow_model", file}}).empty());
  std::filesystem::remove(file);
  EXPECT_EQ(set("learned_flow", {{"direction", "backward"}}).at("direction"), "backward");
  EXPECT_EQ(set("learned_flow", {{"direction", "forward"}}).at("direction"), "forward");
  EXPECT_TRUE(set("learned_flow", {{"preset", "fast"}}).empty()) << "the file is not there any more";
  EXPECT_EQ(set("learned_flow", {}).at("preset"), "medium");
}

TEST_F(TorchNodelets, DepthOfTheRadarComesThroughTheNetwork) {
  const Recorder<Image> depths(handle_, "learned_depth/depth");
  set("learned_depth",
      {{"depth_backend", "torch"}, {"depth_model", network(networks::depthOfFarthestReturn())}});
  // The return 12 m ahead of the base was seen 0.1 s before; the camera sits 1.7 m ahead of the base.
  const float expected = LiveCamera::kReturnAhead - static_cast<float>(VisionWorld::kSpeed * 0.1) - 1.7F;
  EXPECT_TRUE(waitUntil(
      [&] {
        if (depths.count() == 0) return false;
        const cv::Mat depth = matOf(*depths.messages().back(), CV_32FC1);
        return std::abs(depth.at<float>(60, 80) - expected) < 0.1F;
      },
      kPatience));
  EXPECT_EQ(depths.messages().back()->width, 160U);
}

TEST_F(TorchNodelets, DepthOfTheImageComesThroughTheNetwork) {
  const Recorder<Image> depths(handle_, "learned_depth/depth");
  set("learned_depth", {{"depth_backend", "torch"}, {"depth_model", network(networks::depthOfRed())}});
  camera_.set([](LiveCamera::Frame& frame) {
    frame.image = imageOf(frame.image.header.stamp, "mono8",
                          cv::Mat(VisionWorld::kHeight, VisionWorld::kWidth, CV_8UC1, cv::Scalar(55)));
  });
  EXPECT_TRUE(waitUntil(
      [&] {
        return depths.count() > 0 &&
               std::abs(matOf(*depths.messages().back(), CV_32FC1).at<float>(60, 20) - 55.0F) < 0.01F;
      },
      kPatience));
  EXPECT_TRUE(std::isnan(matOf(*depths.messages().back(), CV_32FC1).at<float>(0, 20)));  // cut rows
}

TEST_F(TorchNodelets, ALostNetworkIsReportedAndReplaced) {
  EXPECT_TRUE(waitUntil(
      [&] {
        const Diagnostics::Status status = diagnostics_.latest("lost_flow: flow");
        return status.level == DiagnosticStatus::ERROR &&
               status.message.find("/nowhere/network.pt") != std::string::npos;
      },
      kPatience))
      << diagnostics_.latest("lost_flow: flow").message;
  const Recorder<Flow> flows(handle_, "lost_flow/flow");
  EXPECT_TRUE(waitUntil([&] { return flows.count() >= 3; }, kPatience));
}

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "torch_nodelets_test");
  const ros::NodeHandle keeper;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
