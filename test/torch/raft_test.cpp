// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// RAFT-small with trained weights: exported, run here, and compared with PyTorch and with true flow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "evaluation/simulated_dataroot.h"
#include "fixtures/files.h"
#include "fixtures/tool_run.h"
#include "radar_dot/evaluation/flow_evaluation.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;

constexpr int kIterations = 8;

const fs::path kData = RADAR_DOT_SHARED_DATA;
const fs::path kWeights = kData / ".." / "models" / "raft_small" / "raft-small-kitti.pth";
const fs::path kPair = kData / "kitti_flow_pair";

class Raft : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!fs::exists(kWeights)) return;
    setenv("OMP_WAIT_POLICY", "passive", 0);  // before libtorch is loaded: tests seldom have all cores
    folder_ = std::make_unique<test::TemporaryFolder>();
    exported_ = test::runCommand(std::string(PYTHON) + " " + SCRIPTS + "/export_raft.py --weights " +
                                 kWeights.string() + " --iterations " + std::to_string(kIterations) +
                                 " --output " + network().string());
  }
  void SetUp() override {
    if (!fs::exists(kWeights)) GTEST_SKIP() << kWeights << " is not here";
    if (exported_.text.find("python3-torch") != std::string::npos) GTEST_SKIP() << exported_.text;
    ASSERT_EQ(exported_.exit_code, 0) << exported_.text;
  }

  static fs::path network() { return folder_->path() / "raft_small.pt"; }
  static OpticalFlowParams params(int width, int height) {
    OpticalFlowParams params;
    params.backend = "torch";
    params.working_width = 0;
    params.network.model = network().string();
    params.network.device = "cpu";
    params.network_width = width;
    params.network_height = height;
    return params;
  }
  static cv::Mat image(const char* name) { return cv::imread((kPair / name).string(), cv::IMREAD_COLOR); }

  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline test::Outcome exported_;
};

TEST_F(Raft, ExporterSaysWhatItVerified) {
  EXPECT_NE(exported_.text.find("all 106 weights used"), std::string::npos) << exported_.text;
  EXPECT_NE(exported_.text.find("largest difference"), std::string::npos) << exported_.text;
}

// Python reads the very images that the network gets here: no resizing on either side.
TEST_F(Raft, FlowIsThatOfPython) {
  const cv::Rect cut(100, 10, 640, 360);
  const cv::Mat first = image("frame1.png")(cut).clone();
  const cv::Mat second = image("frame2.png")(cut).clone();
  const fs::path first_file = folder_->path() / "first.png";
  const fs::path second_file = folder_->path() / "second.png";
  const fs::path output = folder_->path() / "flow.raw";
  ASSERT_TRUE(cv::imwrite(first_file.string(), first));
  ASSERT_TRUE(cv::imwrite(second_file.string(), second));
  const test::Outcome python = test::runCommand(
      std::string(PYTHON) + " " + REFERENCE + " " + kWeights.string() + " " + std::to_string(kIterations) +
      " " + first_file.string() + " " + second_file.string() + " " + output.string());
  ASSERT_EQ(python.exit_code, 0) << python.text;
  std::vector<float> expected(2 * 640 * 360);
  std::ifstream(output, std::ios::binary)
      .read(reinterpret_cast<char*>(expected.data()),
            static_cast<std::streamsize>(expected.size() * sizeof(float)));

  const cv::Mat flow = makeOpticalFlow(params(640, 360))->compute(first, second).flow;
  ASSERT_EQ(flow.size(), cv::Size(640, 360));
  float largest = 0.0F;
  double length = 0.0;
  for (int row = 0; row < 360; ++row) {
    for (int column = 0; column < 640; ++column) {
      const auto& vector = flow.at<cv::Vec2f>(row, column);
      const auto pixel = static_cast<std::size_t>(row * 640 + column);
      largest = std::max({largest, std::abs(vector[0] - expected[pixel]),
                          std::abs(vector[1] - expected[pixel + 640 * 360])});
      length += std::sqrt(vector.dot(vector));
    }
  }
  EXPECT_LE(largest, 1e-3F);
  EXPECT_GT(length / (640.0 * 360.0), 10.0);  // it is no still pair
  RecordProperty("largest_difference_micro_px", static_cast<int>(1e6F * largest));
}

TEST_F(Raft, KittiPairInFullResolution) {
  const evaluation::FlowReport report = evaluation::evaluateFlow(
      {kPair / "frame1.png", kPair / "frame2.png", kPair / "flow_gt.png"}, params(1240, 376));
  EXPECT_GT(report.errors.all.compared, 10000U);
  EXPECT_LE(report.errors.all.mean(), 2.6);
  RecordProperty("end_point_error_milli_px", static_cast<int>(1e3 * report.errors.all.mean()));
}

// Images that the network was not trained with, half a second apart, where most of what is near has moved by
// tens of pixels: better than the classical backend, whatever that is there.
TEST_F(Raft, SimulatedPairs) {
  const test::SimulatedDataroot simulated;
  evaluation::FlowEvaluationOptions options;
  options.pairs.max_pairs = 3;
  const auto errorOf = [&](const std::string& flow) {
    options.optical_flow.flow = flow == "torch" ? params(640, 360) : OpticalFlowParams{};
    options.optical_flow.flow.backend = flow;
    options.optical_flow.flow.working_width = 0;
    return evaluation::evaluateFlow(simulated.tables(), 0, options).errors.all;
  };
  const auto network = errorOf("torch");
  const auto dis = errorOf("dis");
  EXPECT_GT(network.compared, 200000U);
  EXPECT_LT(network.mean(), 0.7 * dis.mean());
  options.pairs.pairs = evaluation::ImagePairs::kNext;
  EXPECT_LT(errorOf("torch").median(), 1.0);
  RecordProperty("simulated_milli_px", static_cast<int>(1e3 * network.mean()));
  RecordProperty("simulated_dis_milli_px", static_cast<int>(1e3 * dis.mean()));
}

}  // namespace
}  // namespace radar_dot
