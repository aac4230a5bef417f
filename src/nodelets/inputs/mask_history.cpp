// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/mask_history.h"

#include "nodelets/messages/image_messages.h"
#include "radar_dot/vision/motion_history.h"

namespace radar_dot {

bool sameEvidence(const DynamicSegmentationConfig& a, const DynamicSegmentationConfig& b) {
  return sameFields(a.motion, b.motion) && sameFields(a.motion_uncertainty, b.motion_uncertainty) &&
         a.use_depth_uncertainty == b.use_depth_uncertainty && a.refine == b.refine &&
         a.refine_ground == b.refine_ground && sameFields(a.ground, b.ground) &&
         sameFields(a.refinement, b.refinement);
}

void MaskHistory::remember(const PairInputs& pair, const MotionResult& result) {
  latest_ = pair;
  log_odds_ = logOdds(result);
}

void MaskHistory::clear() {
  backward_.clear();
  latest_.reset();
  log_odds_.release();
}

/// From the first image of a pair to that of the latest one; empty where there is none.
MaskHistory::Backward MaskHistory::backwardTo(const PairInputs& pair) const {
  if (!latest_ || latest_->flow->second_stamp != pair.flow->header.stamp) return {};
  const FlowConstPtr message = backward_.find(pair.flow->header.stamp);
  if (!message || message->second_stamp != latest_->flow->header.stamp) return {};
  const FlowField field = flowOf(*message);
  // Where the grid was changed meanwhile, there is no past.
  const cv::Size grid = pair.motion.flow.size();
  if (field.flow.size() != grid || latest_->motion.flow.size() != grid) return {};
  return {field.flow, field.fb_error};
}

std::optional<MotionInput> MaskHistory::previousPair(const PairInputs& pair) const {
  const Backward backward = backwardTo(pair);
  if (backward.flow.empty()) return std::nullopt;
  return previousPairFromFirst(pair.motion, latest_->motion, backward.flow, backward.fb_error);
}

cv::Mat MaskHistory::beliefFor(const PairInputs& pair, double memory) const {
  if (!latest_ || log_odds_.size() != pair.motion.flow.size()) return {};
  const ros::Time stamp = pair.flow->header.stamp;
  const ros::Time stamp_before = latest_->flow->header.stamp;
  // Flow that runs back in time leads from the first image of a pair to that of the previous pair by itself.
  const bool runs_back = pair.flow->second_stamp == stamp_before && stamp_before < stamp;
  const cv::Mat flow = runs_back ? pair.motion.flow : backwardTo(pair).flow;
  if (flow.empty()) return {};
  return carriedBelief(log_odds_, flow, forgetting((stamp - stamp_before).toSec(), memory));
}

}  // namespace radar_dot
