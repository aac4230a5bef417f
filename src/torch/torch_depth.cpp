// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "radar_dot/vision/just_depth.h"
#include "torch_backends.h"
#include "torch_model.h"

namespace radar_dot {
namespace {

/// Depth by a network with JustDepth's signature.
class TorchDepth : public DepthEstimator {
 public:
  explicit TorchDepth(const DepthParams& params)
      : params_(params),
        model_(TorchModel::load(
            params.network, {{{1, 3, just_depth::kRows, just_depth::kWidth}, {1, 1, 1, just_depth::kWidth}},
                             {1, 1, just_depth::kRows, just_depth::kWidth},
                             "scripts/export_justdepth.py"})) {}

  DepthNeeds needs() const override { return {true, true, false, true}; }

  cv::Mat estimate(const DepthInput& input) override {
    if (input.image.empty()) throw std::invalid_argument("depth 'torch': there is no image");
    just_depth::imagePlanes(input.image, planes_);
    const std::vector<float> columns =
        just_depth::radarColumns(input.radar_points, input.camera, input.T_base_from_camera);
    const cv::Mat output = model_->run({planes_.ptr<float>(), columns.data()}, params_.network.threads);
    cv::Mat depth = just_depth::onGrid(output, {input.camera.width, input.camera.height});
    const auto farthest = static_cast<float>(params_.max_depth);
    for (int row = 0; row < depth.rows; ++row) {
      auto* values = depth.ptr<float>(row);
      for (int column = 0; column < depth.cols; ++column) {
        const bool is_known = values[column] > 0.0F && values[column] <= farthest;
        values[column] = is_known ? values[column] : std::numeric_limits<float>::quiet_NaN();
      }
    }
    return depth;
  }

  cv::Mat relativeStd(const DepthInput& /*input*/, const cv::Mat& depth) const override {
    return constantStd(depth, params_.relative_std);
  }

 private:
  DepthParams params_;
  std::shared_ptr<TorchModel> model_;
  cv::Mat planes_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeTorchDepth(const DepthParams& params) {
  return std::make_unique<TorchDepth>(params);
}

}  // namespace radar_dot
