// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/image_pair_mask.h"

#include <memory>
#include <opencv2/imgproc.hpp>

#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot {

cv::Mat imagePairMask(const cv::Mat& first, const cv::Mat& second, const cv::Mat& depth,
                      const CameraIntrinsics& camera, const Eigen::Isometry3d& T_current_from_previous) {
  OpticalFlowParams params;
  params.initialisation = FlowStart::kExpected;
  params.forward_backward = true;
  const cv::Size grid = workingGrid(first.size(), params.working_width);
  MotionInput input;
  input.camera = camera.scaledTo(grid.width, grid.height);
  input.pixel_scale = static_cast<double>(first.cols) / grid.width;
  input.T_current_from_previous = T_current_from_previous;
  cv::resize(depth, input.depth, grid, 0.0, 0.0, cv::INTER_NEAREST);
  const FlowField field = makeOpticalFlow(params)->compute(
      first, second, expectedFlow(input.camera, T_current_from_previous, input.depth));
  input.flow = field.flow;
  input.flow_valid = field.valid;
  input.fb_error = field.fb_error;
  MotionParams motion;
  motion.score = MotionScore::kUncertainty;
  cv::Mat mask;
  cv::resize(MotionSegmenter(motion).segment(input).mask, mask, first.size(), 0.0, 0.0, cv::INTER_NEAREST);
  return mask;
}

}  // namespace radar_dot
