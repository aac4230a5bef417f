// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "dis_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <stdexcept>

#include "radar_dot/vision/camera_intrinsics.h"
#include "warp.h"

namespace radar_dot {
namespace {

/// Below this OpenCV's DIS chooses pyramids that read outside the image (4.6: ultrafast at 330 x 26 px).
constexpr int kSmallestSide = 32;

cv::Ptr<cv::DISOpticalFlow> makeDis(const std::string& preset) {
  using Dis = cv::DISOpticalFlow;
  if (preset == "ultrafast") return Dis::create(Dis::PRESET_ULTRAFAST);
  if (preset == "fast") return Dis::create(Dis::PRESET_FAST);
  if (preset == "medium") return Dis::create(Dis::PRESET_MEDIUM);
  if (preset != "fine") {
    throw std::invalid_argument(
        fmt::format("optical flow: preset '{}' is not one of ultrafast, fast, medium, fine", preset));
  }
  cv::Ptr<Dis> dis = Dis::create(Dis::PRESET_MEDIUM);
  dis->setFinestScale(0);
  dis->setPatchStride(3);
  dis->setGradientDescentIterations(50);
  dis->setVariationalRefinementIterations(10);
  return dis;
}

void requireImage(const cv::Mat& image, const char* name) {
  if (image.empty()) throw std::invalid_argument(fmt::format("optical flow: the {} image is empty", name));
  if (image.type() != CV_8UC3 && image.type() != CV_8UC1) {
    throw std::invalid_argument(
        fmt::format("optical flow: the {} image must be CV_8UC3 (BGR) or CV_8UC1", name));
  }
}

void requireGrid(const cv::Size& grid) {
  if (std::min(grid.width, grid.height) < kSmallestSide) {
    throw std::invalid_argument(fmt::format(
        "optical flow: a grid of {} x {} px is too small for dis, whose sides must be {} px or more; "
        "use larger images or a larger working_width",
        grid.width, grid.height, kSmallestSide));
  }
}

/// Flow where it is not known is taken from its surroundings, so that a start value has no cracks.
cv::Mat fillUnknown(const cv::Mat& flow) {
  cv::Mat filled(flow.size(), CV_32FC2);
  cv::Mat known(flow.size(), CV_32FC1);
  bool complete = true;
  for (int row = 0; row < flow.rows; ++row) {
    const auto* given = flow.ptr<cv::Vec2f>(row);
    auto* out = filled.ptr<cv::Vec2f>(row);
    auto* is_known = known.ptr<float>(row);
    for (int column = 0; column < flow.cols; ++column) {
      const bool finite = std::isfinite(given[column][0] + given[column][1]);
      out[column] = finite ? given[column] : cv::Vec2f(0.0F, 0.0F);
      is_known[column] = finite ? 1.0F : 0.0F;
      complete = complete && finite;
    }
  }
  if (complete) return filled;
  // The surroundings are far: a coarse grid tells them as well, and quicker.
  constexpr int kCoarser = 8;
  const cv::Size coarse(std::max(1, flow.cols / kCoarser), std::max(1, flow.rows / kCoarser));
  cv::Mat sum, weight;
  cv::resize(filled, sum, coarse, 0.0, 0.0, cv::INTER_AREA);
  cv::resize(known, weight, coarse, 0.0, 0.0, cv::INTER_AREA);
  const cv::Size window(coarse.width / 8 | 1, coarse.height / 8 | 1);
  cv::boxFilter(sum, sum, -1, window);
  cv::boxFilter(weight, weight, -1, window);
  for (int row = 0; row < flow.rows; ++row) {
    const int there = std::min(row * coarse.height / flow.rows, coarse.height - 1);
    const auto* sums = sum.ptr<cv::Vec2f>(there);
    const auto* weights = weight.ptr<float>(there);
    const auto* is_known = known.ptr<float>(row);
    auto* out = filled.ptr<cv::Vec2f>(row);
    for (int column = 0; column < flow.cols; ++column) {
      if (is_known[column] > 0.0F) continue;
      const int cell = column * coarse.width / flow.cols;
      if (weights[cell] > 1e-3F) out[column] = sums[cell] * (1.0F / weights[cell]);
    }
  }
  return filled;
}

/// The way back, at the pixels of the second image that the flow leads to; NaN at those that it does not.
cv::Mat reversed(const cv::Mat& flow) {
  cv::Mat back(flow.size(), CV_32FC2, cv::Scalar::all(std::nan("")));
  for (int row = 0; row < flow.rows; ++row) {
    for (int column = 0; column < flow.cols; ++column) {
      const auto& vector = flow.at<cv::Vec2f>(row, column);
      const float u = static_cast<float>(column) + vector[0];
      const float v = static_cast<float>(row) + vector[1];
      if (!(u > -0.5F && v > -0.5F && u < static_cast<float>(flow.cols) - 0.5F &&
            v < static_cast<float>(flow.rows) - 0.5F))
        continue;
      // Where two lead to the same place, the one that moves more is usually the nearer.
      auto& there = back.at<cv::Vec2f>(static_cast<int>(std::lround(v)), static_cast<int>(std::lround(u)));
      if (!(there.dot(there) >= vector.dot(vector))) there = -vector;
    }
  }
  return back;
}

class DisFlow : public OpticalFlow {
 public:
  explicit DisFlow(const OpticalFlowParams& params) : params_(params), dis_(makeDis(params.preset)) {}

  FlowField compute(const cv::Mat& first, const cv::Mat& second, const cv::Mat& expected) override {
    requireImage(first, "first");
    requireImage(second, "second");
    if (first.size() != second.size()) {
      throw std::invalid_argument(
          fmt::format("optical flow: the images have {} x {} and {} x {} px; they must agree", first.cols,
                      first.rows, second.cols, second.rows));
    }
    const cv::Mat grey_first = onGrid(first);
    const cv::Mat grey_second = onGrid(second);
    requireGrid(grey_first.size());
    const cv::Mat start = startValue(grey_first.size(), expected);
    FlowField field;
    field.flow = run(grey_first, grey_second, start);
    if (params_.forward_backward) {
      const cv::Mat backward =
          run(grey_second, grey_first, start.empty() ? cv::Mat() : fillUnknown(reversed(start)));
      field.valid = forwardBackwardValid(field.flow, backward, params_.forward_backward_absolute,
                                         params_.forward_backward_relative);
    }
    if (params_.initialisation == "temporal") previous_ = field.flow.clone();
    return field;
  }

  void reset() override { previous_.release(); }

 private:
  cv::Mat onGrid(const cv::Mat& image) const {
    cv::Mat grey = image;
    if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    const cv::Size grid = workingGrid(image.size(), params_.working_width);
    if (grid == image.size()) return grey;
    cv::Mat small;
    cv::resize(grey, small, grid, 0.0, 0.0, cv::INTER_AREA);
    return small;
  }

  cv::Mat startValue(const cv::Size& size, const cv::Mat& expected) const {
    if (params_.initialisation == "temporal" && previous_.size() == size) return previous_;
    if (params_.initialisation != "expected" || expected.empty()) return {};
    if (expected.type() != CV_32FC2)
      throw std::invalid_argument("optical flow: the expected flow must be CV_32FC2");
    return resizeFlow(fillUnknown(expected), size);
  }

  /// Motion that the start value already explains is taken out of the second image; what remains is small.
  cv::Mat run(const cv::Mat& first, const cv::Mat& second, const cv::Mat& start) {
    cv::Mat flow;
    if (start.empty()) {
      dis_->calc(first, second, flow);
      return flow;
    }
    dis_->calc(first, warpedBack(second, targetsOf(start)), flow);
    // Where the rest leads, the start value was the one of the pixel it leads to.
    const cv::Mat start_there = warpedBack(start, targetsOf(flow));
    return flow + start_there;
  }

  OpticalFlowParams params_;
  cv::Ptr<cv::DISOpticalFlow> dis_;
  cv::Mat previous_;
};

}  // namespace

std::unique_ptr<OpticalFlow> makeDisFlow(const OpticalFlowParams& params) {
  return std::make_unique<DisFlow>(params);
}

}  // namespace radar_dot
