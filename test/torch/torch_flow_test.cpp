// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/vision/optical_flow.h"
#include "torch_script_file.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;

class TorchFlow : public testing::Test {
 protected:
  OpticalFlowParams paramsOf(const std::string& forward) const {
    const fs::path file = folder_.path() / "network.pt";
    test::writeTorchScript(file, forward);
    OpticalFlowParams params;
    params.backend = "torch";
    params.network.model = file.string();
    params.network.device = "cpu";
    return params;
  }
  static cv::Mat image(int width, int height, const cv::Scalar& bgr = cv::Scalar::all(90)) {
    return cv::Mat(height, width, CV_8UC3, bgr);
  }
  static void expectFlow(const cv::Mat& flow, float u, float v) {
    ASSERT_EQ(flow.type(), CV_32FC2);
    const cv::Vec2f middle = flow.at<cv::Vec2f>(flow.rows / 2, flow.cols / 2);
    EXPECT_NEAR(middle[0], u, 1e-4F);
    EXPECT_NEAR(middle[1], v, 1e-4F);
  }
  /// Refused when it is made, in one line with all the parts.
  static void expectRefused(const OpticalFlowParams& params, const std::vector<std::string>& parts) {
    test::expectRefusal([&] { makeOpticalFlow(params); }, parts);
  }

  test::TemporaryFolder folder_;
};

TEST_F(TorchFlow, IsScaledFromTheNetworkToTheGrid) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(8.0, -3.0));
  // 640 x 360 px of the network are 800 x 450 px of the grid.
  const FlowField field = makeOpticalFlow(params)->compute(image(1600, 900), image(1600, 900));
  EXPECT_EQ(field.flow.size(), cv::Size(800, 450));
  EXPECT_TRUE(field.valid.empty());
  expectFlow(field.flow, 10.0F, -3.75F);
  // Another shape: 1242 x 375.
  params.working_width = 0;
  const FlowField wide = makeOpticalFlow(params)->compute(image(1242, 375), image(1242, 375));
  EXPECT_EQ(wide.flow.size(), cv::Size(1242, 375));
  expectFlow(wide.flow, 8.0F * 1242.0F / 640.0F, -3.0F * 375.0F / 360.0F);
}

TEST_F(TorchFlow, NetworkSeesRedGreenBlueInTheirPlaces) {
  OpticalFlowParams params = paramsOf(test::networks::flowOfColours());
  params.working_width = 0;
  cv::Mat first = image(640, 360, {10, 20, 30});
  first.at<cv::Vec3b>(2, 600) = cv::Vec3b(0, 0, 250);
  const FlowField field = makeOpticalFlow(params)->compute(first, image(640, 360, {40, 50, 60}));
  expectFlow(field.flow, 30.0F, 40.0F);
  EXPECT_FLOAT_EQ(field.flow.at<cv::Vec2f>(2, 600)[0], 250.0F);
  EXPECT_FLOAT_EQ(field.flow.at<cv::Vec2f>(2, 599)[0], 30.0F);
}

TEST_F(TorchFlow, GreyImagesAreColoured) {
  OpticalFlowParams params = paramsOf(test::networks::flowOfColours());
  params.working_width = 0;
  const cv::Mat grey(360, 640, CV_8UC1, cv::Scalar(77));
  expectFlow(makeOpticalFlow(params)->compute(grey, grey).flow, 77.0F, 77.0F);
}

TEST_F(TorchFlow, FlowThereAndBackMustClose) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(8.0, 0.0));
  params.forward_backward = true;
  const FlowField open = makeOpticalFlow(params)->compute(image(640, 360), image(640, 360));
  EXPECT_EQ(cv::countNonZero(open.valid), 0);  // 8 px there, 8 px on
  params = paramsOf(test::networks::constantFlow(0.0, 0.0));
  params.forward_backward = true;
  const FlowField closed = makeOpticalFlow(params)->compute(image(640, 360), image(640, 360));
  EXPECT_EQ(cv::countNonZero(closed.valid), closed.valid.rows * closed.valid.cols);
}

TEST_F(TorchFlow, MayStartFromAnExpectedFlow) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(0.0, 0.0));
  params.initialisation = FlowStart::kExpected;
  params.working_width = 0;
  const cv::Mat expected(90, 160, CV_32FC2, cv::Scalar(5.0, -2.0));  // a quarter of the image
  expectFlow(makeOpticalFlow(params)->compute(image(640, 360), image(640, 360), expected).flow, 20.0F, -8.0F);
}

TEST_F(TorchFlow, AnExchangedFileIsRead) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(1.0, 0.0));
  params.working_width = 0;
  const auto before = makeOpticalFlow(params);
  paramsOf(test::networks::constantFlow(2.0, 0.0));
  fs::last_write_time(params.network.model, fs::file_time_type::clock::now() + std::chrono::seconds(2));
  expectFlow(makeOpticalFlow(params)->compute(image(640, 360), image(640, 360)).flow, 2.0F, 0.0F);
  expectFlow(before->compute(image(640, 360), image(640, 360)).flow, 1.0F, 0.0F);
}

TEST_F(TorchFlow, FilesThatAreNoNetworkAreRefused) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(0.0, 0.0));
  params.network.model.clear();
  expectRefused(params, {"model", "export_raft.py"});
  params.network.model = "/nowhere/network.pt";
  expectRefused(params, {"/nowhere/network.pt", "no such file"});
  const fs::path text = folder_.path() / "text.pt";
  test::writeFile(text, "no network\n");
  params.network.model = text.string();
  expectRefused(params, {"text.pt", "not TorchScript", "export_raft.py"});
}

TEST_F(TorchFlow, NetworksOfAnotherSignatureAreRefused) {
  expectRefused(paramsOf("def forward(self, image):\n    return image\n"),
                {"network.pt", "does not take", "(1, 3, 360, 640)"});
  expectRefused(paramsOf("def forward(self, image1, image2):\n    return torch.matmul(image1, image2)\n"),
                {"network.pt", "does not take"});
  expectRefused(paramsOf("def forward(self, image1, image2):\n    return image1\n"),
                {"network.pt", "(1, 3, 360, 640)", "(1, 2, 360, 640)"});
  expectRefused(paramsOf("def forward(self, image1, image2):\n    return (image1, image2)\n"),
                {"network.pt", "Tuple", "(1, 2, 360, 640)"});
  expectRefused(paramsOf("def forward(self, image1, image2):\n    return image1[:, 0:2].int()\n"),
                {"network.pt", "Int"});
}

TEST_F(TorchFlow, ParametersThatMakeNoSenseAreRefused) {
  OpticalFlowParams params = paramsOf(test::networks::constantFlow(0.0, 0.0));
  params.network_width = 642;
  expectRefused(params, {"network_width", "642", "multiple of 8"});
  params.network_width = 640;
  params.network_height = 0;
  expectRefused(params, {"network_height"});
  params.network_height = 360;
  params.network.device = "gpu";
  expectRefused(params, {"device 'gpu'", "auto, cpu, cuda"});
  params.network.device = "cuda:99";
  expectRefused(params, {"cuda:99"});
}

TEST_F(TorchFlow, ANetworkThatFailsLaterSaysSoInOneLine) {
  // Fails on what it is not proven with: an image that is black.
  const OpticalFlowParams params = paramsOf(R"(
def forward(self, image1, image2):
    if bool(image1.max() == 0.0):
        return torch.matmul(image1, image2)
    return image1[:, 0:2]
)");
  const auto flow = makeOpticalFlow(params);
  test::expectRefusal<std::runtime_error>(
      [&] { flow->compute(image(640, 360, cv::Scalar::all(0)), image(640, 360)); }, {"network.pt", "size"});
  EXPECT_NO_THROW(flow->compute(image(640, 360), image(640, 360)));
}

}  // namespace
}  // namespace radar_dot
