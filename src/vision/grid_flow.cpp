// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/grid_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/network_images.h"
#include "warp.h"

namespace radar_dot {
namespace {

void requireImage(const cv::Mat& image, const char* name) {
  if (image.empty()) throw std::invalid_argument(fmt::format("optical flow: the {} image is empty", name));
  if (image.type() != CV_8UC3 && image.type() != CV_8UC1) {
    throw std::invalid_argument(
        fmt::format("optical flow: the {} image must be CV_8UC3 (BGR) or CV_8UC1", name));
  }
}

cv::Mat flowOn(const cv::Size& grid, const cv::Mat& flow) {
  return flow.size() == grid ? flow : resizeFlow(flow, grid);
}

/// Flow where it is not known, or leads far out of the image, is taken from its surroundings, so that a start
/// value has no cracks.
cv::Mat fillUnknown(const cv::Mat& flow) {
  cv::Mat filled(flow.size(), CV_32FC2);
  cv::Mat known(flow.size(), CV_32FC1);
  bool complete = true;
  for (int row = 0; row < flow.rows; ++row) {
    const auto* given = flow.ptr<cv::Vec2f>(row);
    auto* out = filled.ptr<cv::Vec2f>(row);
    auto* is_known = known.ptr<float>(row);
    for (int column = 0; column < flow.cols; ++column) {
      // What leads farther than the image is wide or high ends nowhere, and is as good as unknown (false for
      // NaN): points that the camera is about to pass have flows of any length.
      const bool usable = std::fabs(given[column][0]) <= static_cast<float>(flow.cols) &&
                          std::fabs(given[column][1]) <= static_cast<float>(flow.rows);
      out[column] = usable ? given[column] : cv::Vec2f(0.0F, 0.0F);
      is_known[column] = usable ? 1.0F : 0.0F;
      complete = complete && usable;
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

/// Length of what the second image shows of a pixel, from here to its neighbour. Not what lies behind the
/// pixel, of which they may be the two borders.
float stretched(float here, float neighbour) {
  constexpr float kMost = 4.0F;
  const float length = neighbour - here;
  return length > 1.0F && length < kMost ? length : 1.0F;
}

/// The way back, at the pixels of the second image that the flow leads to; NaN at those that it does not.
/// What comes nearer grows: a pixel there becomes several.
cv::Mat reversed(const cv::Mat& flow) {
  cv::Mat back(flow.size(), CV_32FC2, cv::Scalar::all(std::nan("")));
  const cv::Rect2f image(-0.5F, -0.5F, static_cast<float>(flow.cols), static_cast<float>(flow.rows));
  for (int row = 0; row < flow.rows; ++row) {
    const int below = std::min(row + 1, flow.rows - 1);
    for (int column = 0; column < flow.cols; ++column) {
      const auto& vector = flow.at<cv::Vec2f>(row, column);
      const auto x = static_cast<float>(column), y = static_cast<float>(row);
      const float u = x + vector[0], v = y + vector[1];
      if (!image.contains({u, v})) continue;
      const float width =
          stretched(u, x + 1.0F + flow.at<cv::Vec2f>(row, std::min(column + 1, flow.cols - 1))[0]);
      const float height = stretched(v, y + 1.0F + flow.at<cv::Vec2f>(below, column)[1]);
      const int left = static_cast<int>(u + 0.5F), top = static_cast<int>(v + 0.5F);
      const int right = std::min(flow.cols, std::max(left + 1, static_cast<int>(u + width + 0.5F)));
      const int bottom = std::min(flow.rows, std::max(top + 1, static_cast<int>(v + height + 0.5F)));
      for (int to_v = top; to_v < bottom; ++to_v) {
        for (int to_u = left; to_u < right; ++to_u) {
          const float du = static_cast<float>(to_u) - u, dv = static_cast<float>(to_v) - v;
          const cv::Vec2f there(du / width - du - vector[0], dv / height - dv - vector[1]);
          // Where two lead to the same place, the one that moves more is usually the nearer.
          auto& known = back.at<cv::Vec2f>(to_v, to_u);
          if (!(known.dot(known) >= there.dot(there))) known = there;
        }
      }
    }
  }
  return back;
}

}  // namespace

GridFlow::GridFlow(OpticalFlowParams params, Images images) : params_(std::move(params)), images_(images) {}
GridFlow::~GridFlow() = default;

/// Motion that the start value already explains is taken out of the second image; what remains is small.
template <typename Run>
cv::Mat GridFlow::runFrom(const cv::Mat& start, const cv::Mat& first, const cv::Mat& second, const Run& run) {
  if (start.empty()) return run(first, second);
  cv::Mat flow = run(first, warpedBack(second, start));
  // Where the rest leads, the start value was the one of the pixel it leads to.
  for (int row = 0; row < flow.rows; ++row) {
    auto* rest = flow.ptr<cv::Vec2f>(row);
    for (int column = 0; column < flow.cols; ++column) {
      rest[column] += flowAt(start, static_cast<float>(column) + rest[column][0],
                             static_cast<float>(row) + rest[column][1]);
    }
  }
  return flow;
}

FlowField GridFlow::compute(const cv::Mat& first, const cv::Mat& second, const cv::Mat& expected) {
  requireImage(first, "first");
  requireImage(second, "second");
  if (first.size() != second.size()) {
    throw std::invalid_argument(
        fmt::format("optical flow: the images have {} x {} and {} x {} px; they must agree", first.cols,
                    first.rows, second.cols, second.rows));
  }
  const cv::Size grid = gridOf(first.size());
  const cv::Mat first_on_grid = prepared(first, grid);
  const cv::Mat second_on_grid = prepared(second, grid);
  const cv::Mat start = startValue(grid, expected);
  const cv::Size wanted = workingGrid(first.size(), params_.working_width);
  cv::Mat there;
  FlowField field;
  const auto go = [&] {
    there = runFrom(start, first_on_grid, second_on_grid,
                    [this](const cv::Mat& from, const cv::Mat& to) { return run(from, to); });
    field.flow = flowOn(wanted, there);
  };
  const auto come = [&] {
    const auto begin = std::chrono::steady_clock::now();
    const cv::Mat start_back = start.empty() ? cv::Mat() : fillUnknown(reversed(start));
    field.backward =
        flowOn(wanted, runFrom(start_back, second_on_grid, first_on_grid,
                               [this](const cv::Mat& from, const cv::Mat& to) { return runBack(from, to); }));
    field.backward_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  if (!params_.forward_backward) {
    go();
  } else if (runsBothWaysAtOnce()) {
    // Not by a thread for each pair: OpenCV keeps a record of every thread that it ever saw. Nor by those of
    // TBB, which OpenCV's loops keep for themselves.
    if (!back_) back_ = std::make_unique<boost::asio::thread_pool>(1);
    std::packaged_task<void()> task(come);
    std::future<void> done = task.get_future();
    boost::asio::post(*back_, std::move(task));
    try {
      go();
    } catch (...) {
      done.wait();  // it uses what is local here
      throw;
    }
    done.get();
  } else {
    go();
    come();
  }
  if (params_.forward_backward) {
    closeForwardBackward(field, field.backward, params_.forward_backward_absolute,
                         params_.forward_backward_relative);
  }
  const auto greyOf = [&wanted](cv::Mat image) {
    if (image.channels() > 1) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    return resizedImage(image, wanted);
  };
  field.grey = greyOf(first_on_grid);
  field.second_grey = greyOf(second_on_grid);
  if (params_.initialisation == FlowStart::kTemporal) previous_ = there.clone();
  return field;
}

cv::Mat GridFlow::prepared(const cv::Mat& image, const cv::Size& grid) const {
  const int channels = images_ == Images::kGrey ? 1 : 3;
  cv::Mat converted = image;
  // The smaller number of channels is the cheaper one to resize.
  if (image.channels() > channels) cv::cvtColor(image, converted, cv::COLOR_BGR2GRAY);
  cv::Mat on_grid = resizedImage(converted, grid);
  if (on_grid.channels() < channels) cv::cvtColor(on_grid, on_grid, cv::COLOR_GRAY2BGR);
  return on_grid;
}

cv::Mat GridFlow::startValue(const cv::Size& grid, const cv::Mat& expected) const {
  if (params_.initialisation == FlowStart::kTemporal && previous_.size() == grid) return previous_;
  if (params_.initialisation != FlowStart::kExpected || expected.empty()) return {};
  if (expected.type() != CV_32FC2)
    throw std::invalid_argument("optical flow: the expected flow must be CV_32FC2");
  return flowOn(grid, fillUnknown(expected));
}

}  // namespace radar_dot
