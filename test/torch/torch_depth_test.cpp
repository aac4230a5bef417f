// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "fixtures/camera_mount.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/vision/depth_estimator.h"
#include "torch_script_file.h"

namespace radar_dot {
namespace {

class TorchDepth : public testing::Test {
 protected:
  TorchDepth() {
    input_.image = cv::Mat(450, 800, CV_8UC3, cv::Scalar(10, 20, 30));
    input_.camera = {500.0, 500.0, 399.5, 224.5, 800, 450};
    input_.T_base_from_camera = test::lookingAhead();
  }
  DepthParams paramsOf(const std::string& forward) const {
    const std::filesystem::path file = folder_.path() / "network.pt";
    test::writeTorchScript(file, forward);
    DepthParams params;
    params.backend = "torch";
    params.network.model = file.string();
    params.network.device = "cpu";
    return params;
  }

  test::TemporaryFolder folder_;
  DepthInput input_;
};

TEST_F(TorchDepth, RadarReachesTheNetworkColumnByColumn) {
  const auto estimator = makeDepthEstimator(paramsOf(test::networks::depthOfRadar()));
  EXPECT_TRUE(estimator->needs().image);
  EXPECT_TRUE(estimator->needs().radar);
  EXPECT_FALSE(estimator->needs().lidar);
  // Columns 700 to 703 of 1600, which are columns 350 and 351 of the grid.
  for (const double u : {700.5, 701.5, 702.5, 703.5})
    input_.radar_points.emplace_back(20.0F, static_cast<float>(-(u - 799.5) / 1000.0 * 20.0), 0.0F);
  const cv::Mat depth = estimator->estimate(input_);
  ASSERT_EQ(depth.size(), cv::Size(800, 450));
  ASSERT_EQ(depth.type(), CV_32FC1);
  EXPECT_NEAR(depth.at<float>(200, 350), 20.0F, 1e-4F);
  EXPECT_NEAR(depth.at<float>(449, 351), 20.0F, 1e-4F);
  EXPECT_TRUE(std::isnan(depth.at<float>(200, 349)));  // 0 m is no depth
  EXPECT_TRUE(std::isnan(depth.at<float>(200, 352)));
  EXPECT_TRUE(std::isnan(depth.at<float>(0, 350)));  // rows that are cut
  EXPECT_TRUE(std::isnan(depth.at<float>(1, 350)));
  EXPECT_NEAR(depth.at<float>(2, 350), 20.0F, 1e-4F);
}

TEST_F(TorchDepth, ImageReachesTheNetworkNormalised) {
  input_.image.at<cv::Vec3b>(300, 100) = cv::Vec3b(0, 0, 80);
  input_.image = input_.image.clone();
  const cv::Mat depth = makeDepthEstimator(paramsOf(test::networks::depthOfRed()))->estimate(input_);
  EXPECT_NEAR(depth.at<float>(300, 700), 30.0F, 1e-3F);
  EXPECT_GT(depth.at<float>(300, 100), 50.0F);
}

TEST_F(TorchDepth, FarIsUnknown) {
  DepthParams params = paramsOf(test::networks::depthOfRed());
  params.max_depth = 29.0;
  const cv::Mat depth = makeDepthEstimator(params)->estimate(input_);
  EXPECT_TRUE(std::isnan(depth.at<float>(300, 700)));
}

TEST_F(TorchDepth, IsAsUncertainAsItsParameterSays) {
  DepthParams params = paramsOf(test::networks::depthOfRed());
  params.relative_std = 0.07;
  const auto estimator = makeDepthEstimator(params);
  const cv::Mat depth = estimator->estimate(input_);
  const cv::Mat stds = estimator->relativeStd(input_, depth);
  EXPECT_FLOAT_EQ(stds.at<float>(300, 700), 0.07F);
  EXPECT_TRUE(std::isnan(stds.at<float>(0, 350)));  // rows that are cut
}

TEST_F(TorchDepth, WrongNetworksAndInputsAreRefused) {
  const auto refused = [this](const std::string& forward, const std::vector<std::string>& parts) {
    test::expectRefusal([&] { makeDepthEstimator(paramsOf(forward)); }, parts);
  };
  refused("def forward(self, image):\n    return image\n",
          {"does not take", "(1, 1, 1, 1600)", "export_justdepth.py"});
  refused("def forward(self, image, radar):\n    return image\n", {"(1, 3, 896, 1600)", "(1, 1, 896, 1600)"});
  DepthParams params = paramsOf(test::networks::depthOfRed());
  params.network.model = "/nowhere.pt";
  test::expectRefusal([&] { makeDepthEstimator(params); }, {"/nowhere.pt"});
  const auto estimator = makeDepthEstimator(paramsOf(test::networks::depthOfRed()));
  input_.image.release();
  test::expectRefusal([&] { estimator->estimate(input_); }, {"image"});
}

}  // namespace
}  // namespace radar_dot
