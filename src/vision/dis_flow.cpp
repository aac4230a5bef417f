// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "dis_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/video/tracking.hpp>
#include <stdexcept>

#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/grid_flow.h"

namespace radar_dot {
namespace {

/// Below this OpenCV's DIS chooses pyramids that read outside the image (4.6: ultrafast at 330 x 26 px).
constexpr int kSmallestSide = 32;

cv::Ptr<cv::DISOpticalFlow> makeDis(FlowPreset preset) {
  using Dis = cv::DISOpticalFlow;
  switch (preset) {
    case FlowPreset::kUltrafast: return Dis::create(Dis::PRESET_ULTRAFAST);
    case FlowPreset::kFast: return Dis::create(Dis::PRESET_FAST);
    case FlowPreset::kLive:
    case FlowPreset::kMedium:
    case FlowPreset::kFine: break;
  }
  cv::Ptr<Dis> dis = Dis::create(Dis::PRESET_MEDIUM);
  if (preset == FlowPreset::kMedium) return dis;
  if (preset == FlowPreset::kLive) {
    dis->setPatchStride(4);
    dis->setGradientDescentIterations(5);
    dis->setVariationalRefinementIterations(0);
    return dis;
  }
  dis->setFinestScale(0);
  dis->setPatchStride(3);
  dis->setGradientDescentIterations(50);
  dis->setVariationalRefinementIterations(10);
  return dis;
}

void requireGrid(const cv::Size& grid) {
  if (std::min(grid.width, grid.height) < kSmallestSide) {
    throw std::invalid_argument(fmt::format(
        "optical flow: a grid of {} x {} px is too small for dis, whose sides must be {} px or more; "
        "use larger images or a larger working_width",
        grid.width, grid.height, kSmallestSide));
  }
}

class DisFlow : public GridFlow {
 public:
  explicit DisFlow(const OpticalFlowParams& params)
      : GridFlow(params, Images::kGrey), dis_(makeDis(params.preset)), dis_back_(makeDis(params.preset)) {}
  bool takesGreyGrid() const override { return true; }

 protected:
  cv::Size gridOf(const cv::Size& image) const override {
    const cv::Size grid = workingGrid(image, params().working_width);
    requireGrid(grid);
    return grid;
  }

  cv::Mat run(const cv::Mat& first, const cv::Mat& second) override {
    cv::Mat flow;
    dis_->calc(first, second, flow);
    return flow;
  }
  cv::Mat runBack(const cv::Mat& second, const cv::Mat& first) override {
    cv::Mat flow;
    dis_back_->calc(second, first, flow);
    return flow;
  }
  bool runsBothWaysAtOnce() const override { return true; }

 private:
  cv::Ptr<cv::DISOpticalFlow> dis_, dis_back_;
};

}  // namespace

std::unique_ptr<OpticalFlow> makeDisFlow(const OpticalFlowParams& params) {
  return std::make_unique<DisFlow>(params);
}

}  // namespace radar_dot
