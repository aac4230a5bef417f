// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "radar_dot/vision/grid_flow.h"
#include "radar_dot/vision/network_images.h"
#include "torch_backends.h"
#include "torch_model.h"

namespace radar_dot {
namespace {

constexpr int kSideStep = 8;       // px; networks of the kind of RAFT work at an eighth of the resolution
constexpr int kSmallestSide = 64;  // px

// The network gets 0 to 255.
constexpr std::array<double, 3> kAsTheyAre = {1.0, 1.0, 1.0};
constexpr std::array<double, 3> kNoOffset = {0.0, 0.0, 0.0};

void requireSide(const char* name, int side) {
  if (side < kSmallestSide || side % kSideStep != 0) {
    throw std::invalid_argument(fmt::format("optical flow: {} is {}, must be a multiple of {} px, {} or more",
                                            name, side, kSideStep, kSmallestSide));
  }
}

NetworkSignature signatureOf(const OpticalFlowParams& params) {
  return {{{1, 3, params.network_height, params.network_width},
           {1, 3, params.network_height, params.network_width}},
          {1, 2, params.network_height, params.network_width},
          "scripts/export_raft.py"};
}

/// Flow by a network: two images (1, 3, H, W), red, green, blue, 0 to 255, to (1, 2, H, W), px.
class TorchFlow : public GridFlow {
 public:
  explicit TorchFlow(const OpticalFlowParams& params)
      : GridFlow(params, Images::kColour), model_(TorchModel::load(params.network, signatureOf(params))) {}

 protected:
  cv::Size gridOf(const cv::Size& image) const override {
    (void)image;  // any size and shape is brought to the network's
    return {params().network_width, params().network_height};
  }

  cv::Mat run(const cv::Mat& first, const cv::Mat& second) override {
    cv::Mat first_planes, second_planes;
    colourPlanes(first, kAsTheyAre, kNoOffset, first_planes);
    colourPlanes(second, kAsTheyAre, kNoOffset, second_planes);
    const cv::Mat output =
        model_->run({first_planes.ptr<float>(), second_planes.ptr<float>()}, params().network.threads);
    const cv::Mat components[] = {output.rowRange(0, first.rows),
                                  output.rowRange(first.rows, 2 * first.rows)};
    cv::Mat flow;
    cv::merge(components, 2, flow);
    return flow;
  }

 private:
  std::shared_ptr<TorchModel> model_;
};

}  // namespace

std::unique_ptr<OpticalFlow> makeTorchFlow(const OpticalFlowParams& params) {
  requireSide("network_width", params.network_width);
  requireSide("network_height", params.network_height);
  return std::make_unique<TorchFlow>(params);
}

}  // namespace radar_dot
