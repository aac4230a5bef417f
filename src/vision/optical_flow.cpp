// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/optical_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "backend_registry.h"
#include "dis_flow.h"
#include "parallel_rows.h"
#include "vectorised.h"
#include "warp.h"

namespace radar_dot {
namespace {

using Registry = BackendRegistry<OpticalFlowFactory>;

Registry& registry() {
  static Registry instance("optical flow", {{"dis", makeDisFlow}});
  return instance;
}

void requireFlow(const cv::Mat& flow, const char* name) {
  if (flow.empty() || flow.type() != CV_32FC2)
    throw std::invalid_argument(fmt::format("{}: must be a CV_32FC2 image that is not empty", name));
}

/// One row of closeForwardBackward(): pairs of the flow and of the flow back where it leads.
struct ClosureRow {
  const float *forward, *back;
  float* gaps;
  std::uint8_t* valid;
};

RADAR_DOT_VECTORISED void closeRow(const ClosureRow& row, int v, const cv::Size& grid, float tolerance,
                                   float share) {
  const float *f = row.forward, *b = row.back;
  float* gaps = row.gaps;
  std::uint8_t* valid = row.valid;
  const auto last_u = static_cast<float>(grid.width - 1);
  const auto last_v = static_cast<float>(grid.height - 1);
  const auto from_v = static_cast<float>(v);
  const int columns = grid.width;
  for (int i = 0; i < columns; ++i) {
    const float fx = f[2 * i], fy = f[2 * i + 1], bx = b[2 * i], by = b[2 * i + 1];
    const float x = fx + bx, y = fy + by;
    const float length = std::sqrt(fx * fx + fy * fy) + std::sqrt(bx * bx + by * by);
    // Without branches; false for NaN.
    const float to_u = static_cast<float>(i) + fx, to_v = from_v + fy;
    const bool inside = (static_cast<int>(to_u >= 0.0F) & static_cast<int>(to_v >= 0.0F) &
                         static_cast<int>(to_u <= last_u) & static_cast<int>(to_v <= last_v)) != 0;
    const float gap = inside ? std::sqrt(x * x + y * y) : std::numeric_limits<float>::quiet_NaN();
    gaps[i] = gap;
    valid[i] = gap <= tolerance + share * length ? 255 : 0;  // NaN closes nothing
  }
}

}  // namespace

std::unique_ptr<OpticalFlow> makeOpticalFlow(const OpticalFlowParams& params) {
  validate(params);
  return registry().find(params.backend)(params);
}

void registerOpticalFlow(const std::string& backend, OpticalFlowFactory factory) {
  registry().add(backend, std::move(factory));
}

void closeForwardBackward(FlowField& forward, const cv::Mat& backward, double absolute, double relative) {
  requireFlow(forward.flow, "forward flow");
  requireFlow(backward, "backward flow");
  if (forward.flow.size() != backward.size())
    throw std::invalid_argument("forward and backward flow have different sizes");
  forward.valid.create(backward.size(), CV_8UC1);
  forward.fb_error.create(backward.size(), CV_32FC1);
  parallelRows(backward.rows, [&](int row) {
    const auto* flow = forward.flow.ptr<cv::Vec2f>(row);
    std::vector<cv::Vec2f> back(static_cast<std::size_t>(backward.cols));
    for (int column = 0; column < backward.cols; ++column) {
      back[static_cast<std::size_t>(column)] = flowAt(backward, static_cast<float>(column) + flow[column][0],
                                                      static_cast<float>(row) + flow[column][1]);
    }
    closeRow({forward.flow.ptr<float>(row), back.front().val, forward.fb_error.ptr<float>(row),
              forward.valid.ptr<std::uint8_t>(row)},
             row, backward.size(), static_cast<float>(absolute), static_cast<float>(relative));
  });
}

FlowField backwardField(const FlowField& field, const OpticalFlowParams& params) {
  FlowField back;
  back.flow = field.backward;
  closeForwardBackward(back, field.flow, params.forward_backward_absolute, params.forward_backward_relative);
  return back;
}

cv::Mat textureStd(const cv::Mat& grey) {
  constexpr double kChange = 2.0;        // grey values from px to px, rms, that leave 1 px
  constexpr double kLeastChange = 0.01;  // of an image without any
  constexpr int kWindows = 26;           // in the width of the image
  cv::Mat smooth, change, downwards;
  cv::GaussianBlur(grey, smooth, {}, 0.8);
  cv::Scharr(smooth, change, CV_32F, 1, 0, 1.0 / 32.0);
  cv::Scharr(smooth, downwards, CV_32F, 0, 1, 1.0 / 32.0);
  cv::multiply(change, change, change);
  cv::accumulateSquare(downwards, change);
  const int window = grey.cols / kWindows | 1;
  cv::boxFilter(change, change, -1, {window, window});
  cv::Mat stds(change.size(), CV_32FC1);
  parallelRows(stds.rows, [&](int row) {
    const float* from = change.ptr<float>(row);
    float* to = stds.ptr<float>(row);
    constexpr auto kLeast = static_cast<float>(kLeastChange * kLeastChange);
    for (int column = 0; column < stds.cols; ++column)
      to[column] = static_cast<float>(kChange) / std::sqrt(std::max(from[column], kLeast));
  });
  return stds;
}

cv::Mat resizeFlow(const cv::Mat& flow, const cv::Size& size) {
  requireFlow(flow, "flow");
  if (size.width <= 0 || size.height <= 0) {
    throw std::invalid_argument(
        fmt::format("flow cannot be resized to {} x {} px; give a size above zero", size.width, size.height));
  }
  if (flow.size() == size) return flow.clone();
  cv::Mat resized;
  cv::resize(flow, resized, size, 0.0, 0.0, cv::INTER_LINEAR);
  cv::multiply(
      resized,
      cv::Scalar(static_cast<double>(size.width) / flow.cols, static_cast<double>(size.height) / flow.rows),
      resized);
  return resized;
}

}  // namespace radar_dot
