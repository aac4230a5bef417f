// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/optical_flow.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "backend_registry.h"
#include "dis_flow.h"
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
  const cv::Mat targets = targetsOf(forward.flow);
  const cv::Mat back = warpedBack(backward, targets);
  forward.valid.create(backward.size(), CV_8UC1);
  forward.fb_error.create(backward.size(), CV_32FC1);
  const auto tolerance = static_cast<float>(absolute);
  const auto share = static_cast<float>(relative);
  const auto last_u = static_cast<float>(backward.cols - 1);
  const auto last_v = static_cast<float>(backward.rows - 1);
  for (int row = 0; row < backward.rows; ++row) {
    const auto* f = forward.flow.ptr<cv::Vec2f>(row);
    const auto* b = back.ptr<cv::Vec2f>(row);
    const auto* to = targets.ptr<cv::Vec2f>(row);
    auto* gaps = forward.fb_error.ptr<float>(row);
    auto* out = forward.valid.ptr<std::uint8_t>(row);
    for (int column = 0; column < backward.cols; ++column) {
      const float x = f[column][0] + b[column][0];
      const float y = f[column][1] + b[column][1];
      const float length = std::sqrt(f[column].dot(f[column])) + std::sqrt(b[column].dot(b[column]));
      const float u = to[column][0];
      const float v = to[column][1];
      const bool inside = u >= 0.0F && v >= 0.0F && u <= last_u && v <= last_v;  // false for NaN
      gaps[column] = inside ? std::sqrt(x * x + y * y) : std::numeric_limits<float>::quiet_NaN();
      out[column] = gaps[column] <= tolerance + share * length ? 255 : 0;  // NaN closes nothing
    }
  }
}

FlowField backwardField(const FlowField& field, const OpticalFlowParams& params) {
  FlowField back;
  back.flow = field.backward;
  closeForwardBackward(back, field.flow, params.forward_backward_absolute, params.forward_backward_relative);
  return back;
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
