// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <opencv2/core/mat.hpp>
#include <optional>

#include "nodelets/inputs/stamp_cache.h"
#include "radar_dot/Flow.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {

/// What a mask is made of; the messages own the pixels.
struct PairInputs {
  FlowConstPtr flow;
  sensor_msgs::ImageConstPtr depth, next_depth, depth_std;
  MotionInput motion;
};

/// Do pairs score the same with both? If not, what is known of the images before does not go with what comes.
/// What a history is used for, how long it lasts and when inputs are taken does not matter.
bool sameEvidence(const DynamicSegmentationConfig& a, const DynamicSegmentationConfig& b);

/// What a stream of masks knows of the images before: the latest pair, what was believed of its first image,
/// and the flows back.
class MaskHistory {
 public:
  /// A flow from the second image of a pair to its first.
  void addBackward(const FlowConstPtr& flow) { backward_.add(flow); }
  void remember(const PairInputs& pair, const MotionResult& result);
  void clear();

  /// The first image of a pair, seen together with the one before it: where the latest pair ended with it,
  /// and its flow back has come. None else.
  /// @throws std::invalid_argument where that flow does not have the form of a flow
  std::optional<MotionInput> previousPair(const PairInputs& pair) const;

  /// What is believed of the pixels of its first image; empty where the latest mask does not reach it.
  /// @param memory  s, see forgetting
  /// @throws std::invalid_argument as previousPair
  cv::Mat beliefFor(const PairInputs& pair, double memory) const;

 private:
  struct Backward {
    cv::Mat flow, fb_error;
  };
  Backward backwardTo(const PairInputs& pair) const;

  StampCache<Flow> backward_;
  std::optional<PairInputs> latest_;
  cv::Mat log_odds_;  // at the first image of the latest pair
};

}  // namespace radar_dot
