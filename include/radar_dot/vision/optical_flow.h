// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/vision/network_params.h"

namespace radar_dot {

/// Optical flow on a grid that may be coarser than the images.
struct FlowField {
  cv::Mat
      flow;  ///< CV_32FC2, px OF THIS GRID: pixel (u, v) of the first image is at (u, v) + flow in the second
  cv::Mat valid;  ///< CV_8UC1 of the same size, 255 = reliable; empty: everything is
  /// CV_32FC1, px OF THIS GRID: forward-backward error of the flow, NaN where it leaves the image. Empty without
  /// forward_backward.
  cv::Mat fb_error = {};
  /// CV_32FC2, px OF THIS GRID: from the second image to the first. Empty without forward_backward.
  cv::Mat backward = {};
};

/// Parameters of makeOpticalFlow; a backend ignores what it does not know.
struct OpticalFlowParams {
  std::string backend = "dis";  ///< "dis"; "torch", a network; or what was registered
  /// px, width of the grid of the flow; 0 = that of the images. "dis" computes on it: half the resolution of
  /// a 1600x900 camera costs a fifth, and on soft images loses little.
  int working_width = 800;
  /// "ultrafast", "fast", "medium": OpenCV's; "fine": finest scale 0, patch stride 3, 50 gradient-descent
  /// and 10 variational iterations, three to six times as slow, with 0.6 to 0.8 of the error.
  std::string preset = "medium";
  /// "none"; "temporal": starts from the flow of the previous pair, for streams of images;
  /// "expected": starts from the flow given as `expected`, for motion too large to be found from nothing.
  std::string initialisation = "none";
  /// Also computes the flow back, and marks pixels as not valid where the two do not close. Doubles the time.
  /// What moves far is what closes least: masks get precise and incomplete.
  bool forward_backward = false;
  /// A pixel is valid where |f(p) + b(p + f(p))| <= absolute + relative (|f| + |b|), px of the grid.
  double forward_backward_absolute = 1.0;
  double forward_backward_relative = 0.05;

  // torch
  NetworkParams network;
  /// px, size of the images that the network gets, whatever their shape; multiples of 8.
  int network_width = 640;
  int network_height = 360;
};

/// Dense optical flow between two images of equal size, CV_8UC3 (BGR) or CV_8UC1. Not thread-safe; may keep
/// state of the previous pair.
class OpticalFlow {
 public:
  virtual ~OpticalFlow() = default;

  /// @param expected  flow of a static world, CV_32FC2 on any grid in px of that grid, NaN where unknown; or
  ///                  empty. Only a start value: it never appears in the result by itself.
  /// @throws std::invalid_argument for empty images, other types, sizes that differ, or a grid with a side
  /// under 32 px.
  virtual FlowField compute(const cv::Mat& first, const cv::Mat& second, const cv::Mat& expected) = 0;
  FlowField compute(const cv::Mat& first, const cv::Mat& second) { return compute(first, second, {}); }
  /// Forgets the previous pair.
  virtual void reset() {}
};

/// Makes the backend `params.backend`. One that is not registered is looked for in the shared library
/// `libradar_dot_backend_<name>.so`, beside this one or where the loader looks, which registers it.
/// @throws std::invalid_argument for invalid parameters, or a backend that is not there, with the
///         names of those that are.
std::unique_ptr<OpticalFlow> makeOpticalFlow(const OpticalFlowParams& params = {});

/// Adds a backend, or replaces one, for every later makeOpticalFlow. Thread-safe.
using OpticalFlowFactory = std::function<std::unique_ptr<OpticalFlow>(const OpticalFlowParams&)>;
void registerOpticalFlow(const std::string& backend, OpticalFlowFactory factory);
/// Names of the backends at hand, sorted.
std::vector<std::string> opticalFlowBackends();

/// The flow back of a field that was computed with forward_backward, with its own gap.
/// @throws std::invalid_argument where the field has none
FlowField backwardField(const FlowField& field, const OpticalFlowParams& params);

/// 255 where forward and backward flow (CV_32FC2, same size) close: the paper's "unreliable correspondences"
/// are the others. A pixel whose flow leaves the image, or is not finite, is not valid.
cv::Mat forwardBackwardValid(const cv::Mat& forward, const cv::Mat& backward, double absolute,
                             double relative);

/// Both of FlowField: `valid` as forwardBackwardValid, and `fb_error`, |f(p) + b(p + f(p))|, CV_32FC1, px, NaN
/// where the flow leaves the image, or is not finite.
void closeForwardBackward(FlowField& forward, const cv::Mat& backward, double absolute, double relative);

/// Flow on another grid, bilinear, with its vectors scaled to px of that grid.
cv::Mat resizeFlow(const cv::Mat& flow, const cv::Size& size);

}  // namespace radar_dot
