// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/network_params.h"
#include "radar_dot/vision/shared_fields.h"

namespace radar_dot {

/// Optical flow on a grid that may be coarser than the images.
struct FlowField {
  cv::Mat
      flow;  ///< CV_32FC2, px OF THIS GRID: pixel (u, v) of the first image is at (u, v) + flow in the second
  cv::Mat valid;  ///< CV_8UC1 of the same size, 255 = reliable; empty: everything is
  /// CV_32FC1, px OF THIS GRID: forward-backward error of the flow, NaN where it leaves the image. Empty
  /// without forward_backward.
  cv::Mat fb_error = {};
  /// CV_8UC1 of the same size: the first image, for those who want to know what the flow was seen on. May be
  /// the image itself. Empty where the flow comes from no images.
  cv::Mat grey = {};
  cv::Mat second_grey = {};  ///< the second image, as `grey`
  /// CV_32FC2, px OF THIS GRID: from the second image to the first. Empty without forward_backward.
  cv::Mat backward = {};
  double backward_seconds = 0.0;  ///< that the way back and its comparison took
};

/// Effort of the backend dis.
enum class FlowPreset { kUltrafast, kFast, kLive, kMedium, kFine };
template <>
struct EnumNames<FlowPreset> {
  static constexpr EnumName<FlowPreset> kValues[] = {
      {FlowPreset::kUltrafast, "ultrafast", "of OpenCV"},
      {FlowPreset::kFast, "fast", "of OpenCV"},
      {FlowPreset::kLive, "live",
       "medium with fewer patches and steps, in a third of its time; enough for starts that are near, as "
       "expected"},
      {FlowPreset::kMedium, "medium", "of OpenCV"},
      {FlowPreset::kFine, "fine",
       "finest scale, small stride: 3 to 6 times as slow as medium, 0.6 to 0.8 of its error"}};
};

/// What the flow of a pair starts from.
enum class FlowStart { kNone, kTemporal, kExpected };
template <>
struct EnumNames<FlowStart> {
  static constexpr EnumName<FlowStart> kValues[] = {
      {FlowStart::kNone, "none", "zero: every pair by itself"},
      {FlowStart::kTemporal, "temporal", "the flow of the previous pair, for streams of images"},
      {FlowStart::kExpected, "expected",
       "the flow of a static world, for large motion; needs depth, camera_info and ego/twist"}};
};

/// Parameters of makeOpticalFlow; a backend ignores what it does not know.
struct OpticalFlowParams {
  std::string backend = "dis";
  int working_width = 800;
  FlowPreset preset = FlowPreset::kMedium;
  FlowStart initialisation = FlowStart::kNone;
  bool forward_backward = false;
  double forward_backward_absolute = 1.0;
  double forward_backward_relative = 0.05;
  NetworkParams network;
  int network_width = 640;
  int network_height = 360;

  void describe(FieldList& fields) {
    fields.group("Flow");
    fields.add(
        "flow_backend", backend,
        "dis: OpenCV's dense inverse search; torch: a network; or a registered one. Evaluators also take "
        "ground_truth and files");
    describeWorkingWidth(working_width, fields);
    fields.add("preset", preset, "Effort of the backend dis");
    fields.add("initialisation", initialisation, "Initial flow of a pair");
    fields.add(
        "forward_backward", forward_backward,
        "Compute the backward flow as well, and mark pixels whose forward-backward error is too large; "
        "doubles the time");
    fields.add("forward_backward_absolute", forward_backward_absolute,
               "Largest forward-backward error |f(p) + b(p + f(p))| of a valid pixel, in px of the grid",
               "px", {0.0, 1000.0});
    fields.add("forward_backward_relative", forward_backward_relative,
               "In addition, as a fraction of the lengths of both flows", "", {0.0, 10.0});
    fields.group("Network");
    fields.add("flow_model", network.model, "TorchScript file of export_raft.py, for flow_backend torch");
    fields.add("network_width", network_width, "Width of the images for the network, a multiple of 8", "px",
               {64, 8192});
    fields.add("network_height", network_height, "Height of the images for the network, a multiple of 8",
               "px", {64, 8192});
    network.describe(fields);
  }
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
  /// Does it make of images what it would make of them in grey on the grid of `working_width`?
  virtual bool takesGreyGrid() const { return false; }
};

/// Makes the backend `params.backend`. One that is not registered is looked for in the shared library
/// `libradar_dot_backend_<name>.so`, beside this one or where the loader looks, which registers it.
/// @throws std::invalid_argument for invalid parameters, or a backend that is not there, with the
///         names of those that are.
std::unique_ptr<OpticalFlow> makeOpticalFlow(const OpticalFlowParams& params = {});

/// Adds a backend, or replaces one, for every later makeOpticalFlow. Thread-safe.
using OpticalFlowFactory = std::function<std::unique_ptr<OpticalFlow>(const OpticalFlowParams&)>;
void registerOpticalFlow(const std::string& backend, OpticalFlowFactory factory);

/// The flow back of a field that was computed with forward_backward, with its own gap.
/// @throws std::invalid_argument where the field has none
FlowField backwardField(const FlowField& field, const OpticalFlowParams& params);

/// Fills both of FlowField: `valid`, 255 where forward and backward flow (CV_32FC2, same size) close (the
/// paper's "unreliable correspondences" are the others), and `fb_error`, |f(p) + b(p + f(p))|, CV_32FC1, px.
/// A pixel whose flow leaves the image, or is not finite, is not valid, its error NaN.
void closeForwardBackward(FlowField& forward, const cv::Mat& backward, double absolute, double relative);

/// 1 sigma of the flow of each pixel, by the texture around it: without any, flow is that of the
/// surroundings, so that sky takes part in the motion of what drives before it.
/// @param grey  CV_8UC1, the first image on the grid of the flow   @return CV_32FC1, px of the grid
cv::Mat textureStd(const cv::Mat& grey);

/// Flow on another grid, bilinear, with its vectors scaled to px of that grid.
cv::Mat resizeFlow(const cv::Mat& flow, const cv::Size& size);

}  // namespace radar_dot
