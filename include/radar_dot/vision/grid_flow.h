// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "radar_dot/vision/optical_flow.h"

namespace boost::asio {
class thread_pool;
}

namespace radar_dot {

/// What a backend of dense flow need not do again: it checks the images and brings them to a grid, starts
/// from the flow of the previous pair or from an expected one, computes the way back, and gives its result on
/// the grid that `working_width` asks for. A backend says which grid it computes on, and computes.
class GridFlow : public OpticalFlow {
 public:
  ~GridFlow() override;
  FlowField compute(const cv::Mat& first, const cv::Mat& second, const cv::Mat& expected) final;
  void reset() override { previous_.release(); }

 protected:
  enum class Images { kGrey, kColour };

  /// @param images  what run() takes: CV_8UC1, or CV_8UC3 (BGR)
  GridFlow(OpticalFlowParams params, Images images);

  /// Size that run() takes for images of this size, px. @throws std::invalid_argument when they are too small
  virtual cv::Size gridOf(const cv::Size& image) const = 0;
  /// Flow from one image to the other, both of the size of the grid: CV_32FC2, px of the grid.
  virtual cv::Mat run(const cv::Mat& first, const cv::Mat& second) = 0;
  /// The same for the way back. Where it may be called while run() works, two cores share a pair.
  virtual cv::Mat runBack(const cv::Mat& second, const cv::Mat& first) { return run(second, first); }
  virtual bool runsBothWaysAtOnce() const { return false; }

  const OpticalFlowParams& params() const noexcept { return params_; }

 private:
  cv::Mat prepared(const cv::Mat& image, const cv::Size& grid) const;
  cv::Mat startValue(const cv::Size& grid, const cv::Mat& expected) const;
  template <typename Run>
  static cv::Mat runFrom(const cv::Mat& start, const cv::Mat& first, const cv::Mat& second, const Run& run);

  OpticalFlowParams params_;
  Images images_;
  cv::Mat previous_;                                // flow of the previous pair, on the grid
  std::unique_ptr<boost::asio::thread_pool> back_;  // the thread of the way back, from the first one on
};

}  // namespace radar_dot
