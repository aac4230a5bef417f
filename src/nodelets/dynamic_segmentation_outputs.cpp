// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The outputs of DynamicSegmentationNodelet.
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "nodelets/dynamic_segmentation_nodelet.h"
#include "nodelets/messages/refined_twist.h"
#include "radar_dot/common/base_motion.h"
#include "vision/resize_nearest.h"

namespace radar_dot {
namespace {

// Part of the refined yaw rate that is the image's own, below which it tells nothing.
constexpr double kLeastGain = 0.2;

/// |flow - expected|, px; NaN where either is unknown.
cv::Mat residualOf(const cv::Mat& flow, const cv::Mat& expected) {
  cv::Mat residual(flow.size(), CV_32FC1);
  for (int row = 0; row < flow.rows; ++row) {
    const auto* observed = flow.ptr<cv::Vec2f>(row);
    const auto* predicted = expected.ptr<cv::Vec2f>(row);
    auto* values = residual.ptr<float>(row);
    for (int column = 0; column < flow.cols; ++column) {
      const cv::Vec2f difference = observed[column] - predicted[column];
      values[column] = std::hypot(difference[0], difference[1]);
    }
  }
  return residual;
}

}  // namespace

void DynamicSegmentationNodelet::publish(const Inputs& inputs, const MaskOutcome& outcome) {
  const MotionResult& result = outcome.result;
  const MotionInput& input = outcome.input;
  const std_msgs::Header& header = inputs.messages.flow->header;
  const cv::Size image(static_cast<int>(inputs.messages.flow->image_width),
                       static_cast<int>(inputs.messages.flow->image_height));
  const cv::Size size = config_.full_size ? image : result.mask.size();
  if (mask_publisher_.getNumSubscribers() > 0)
    mask_publisher_.publish(imageMessage(header, "mono8", resizeNearest(result.mask, size)));
  if (valid_publisher_.getNumSubscribers() > 0)
    valid_publisher_.publish(imageMessage(header, "mono8", resizeNearest(result.valid, size)));
  if (score_publisher_.getNumSubscribers() > 0)
    score_publisher_.publish(imageMessage(header, "32FC1", result.score));
  if (inputs.pair.wants_motion_depth && outcome.motion_depth) {
    // Where something moves, the given depth is the better one.
    const MotionDepthResult& depth = *outcome.motion_depth;
    const cv::Mat refused =
        (depth.origin == static_cast<int>(DepthOrigin::kRefused)) | (depth.depth > config_.motion.max_depth);
    const auto publish_depth = [&](const ros::Publisher& publisher, const cv::Mat& values) {
      if (publisher.getNumSubscribers() == 0) return;
      cv::Mat shown = values.clone();
      shown.setTo(std::numeric_limits<double>::quiet_NaN(), refused);
      publisher.publish(imageMessage(header, "32FC1", shown));
    };
    publish_depth(motion_depth_std_publisher_, depth.relative_std);  // first, as in Depth
    publish_depth(motion_depth_publisher_, depth.depth);
  }
  yaw_rates_.expire(std::max(inputs.pair.first_time, inputs.pair.second_time));
  if (config_.refine) {
    const StampedTwist velocity = refinedVelocity(inputs.pair, input);
    compareYawRates(inputs, velocity, outcome.rotation_weight);
    std_msgs::Header refined;
    refined.stamp = std::max(header.stamp, inputs.messages.flow->second_stamp);
    refined.frame_id = extrinsics_->baseFrame();
    const bool is_finite =
        velocity.linear.allFinite() && velocity.angular.allFinite() && velocity.covariance.allFinite();
    if (refined_publisher_.getNumSubscribers() > 0 && is_finite)
      refined_publisher_.publish(refinedTwist(velocity, refined));
  }
  const bool wants_residual = residual_publisher_.getNumSubscribers() > 0;
  const bool wants_expected = expected_flow_publisher_.getNumSubscribers() > 0;
  if (!wants_residual && !wants_expected) return;
  const cv::Mat expected = expectedFlow(input.camera, input.T_current_from_previous, input.depth);
  if (wants_expected) expected_flow_publisher_.publish(imageMessage(header, "32FC2", expected));
  if (wants_residual)
    residual_publisher_.publish(imageMessage(header, "32FC1", residualOf(input.flow, expected)));
}

/// The yaw rate of the image alone: the refined one has that of the twists in it, as much as it is trusted.
/// @param weight  of the twists' rotation in the refined one
void DynamicSegmentationNodelet::compareYawRates(const Inputs& inputs, const StampedTwist& refined,
                                                 double weight) {
  if (motion_->hasRotation() && !inputs.without_rotation) return;
  const MaskPair& pair = inputs.pair;
  const double given = baseVelocity(pair.T_first_from_second, pair.second_time - pair.first_time).angular.z();
  const double variance = pair.motion_uncertainty.yaw_rate_std * pair.motion_uncertainty.yaw_rate_std;
  const double gain = 1.0 - weight * refined.covariance(5, 5) / variance;
  if (!(gain > kLeastGain)) return;
  const double image = given + (refined.angular.z() - given) / gain;
  yaw_rates_.add(refined.time, given, std::sqrt(variance / gain), image);
  const std::string warning = yaw_rates_.warning("'" + twist_input_->topic() + "'", "the image");
  if (!warning.empty()) warn("yaw rate", warning);
}

void DynamicSegmentationNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (dropped_since_report_ > 0) {
    status.summaryf(masks_since_report_ > 0 ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                    "%zu flows without a mask: %s", dropped_since_report_, drop_reason_.c_str());
  } else if (withoutOutput() > silentAfter()) {
    status.summaryf(DiagnosticStatus::ERROR, "no mask for %.1f s", withoutOutput());
  } else if (masks_since_report_ > 0 && valid_share_ == 0.0) {
    status.summary(DiagnosticStatus::WARN, "no pixel has both depth and flow");
  } else {
    status.summaryf(DiagnosticStatus::OK, "%zu masks since the last report", masks_since_report_);
  }
  if (without_next_depth_since_report_ > 0) {
    status.mergeSummaryf(DiagnosticStatus::WARN, "%zu masks without the depth of the second image",
                         without_next_depth_since_report_);
  }
  if (without_rotation_since_report_ > 0) {
    status.mergeSummaryf(DiagnosticStatus::WARN, "%zu masks without a rotation from %s",
                         without_rotation_since_report_, motion_->rotationText().c_str());
  }
  if (without_depth_std_since_report_ > 0) {
    status.mergeSummaryf(DiagnosticStatus::WARN, "%zu masks without the uncertainty of depth on '%s'",
                         without_depth_std_since_report_, depth_std_input_->topic().c_str());
  }
  // The first mask of a stream has no past.
  if (config_.looksBack() && masks_since_report_ > 1 && without_past_since_report_ >= masks_since_report_) {
    const OpticalFlowConfig flow;
    status.mergeSummaryf(
        DiagnosticStatus::WARN,
        "masks do not look back: nothing on '%s' goes with the flow (it needs %s, and %s %s)",
        backward_input_->topic().c_str(), nameOf(flow, flow.flow.forward_backward),
        nameOf(flow, flow.direction), toString(FlowDirection::kForward).data());
  }
  if (const std::string warning = yaw_rates_.warning("'" + twist_input_->topic() + "'", "the image");
      !warning.empty())
    status.mergeSummary(DiagnosticStatus::WARN, warning);
  if (const std::string contradiction = motion_->contradiction(); !contradiction.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, contradiction);
    warn("contradiction", contradiction);
  }
  status.add("rotation", motion_->rotationText());
  status.addf("yaw rate of the twists (rad/s)", "%.3f", yaw_rates_.rate());
  status.addf("yaw rate of the image (rad/s)", "%.3f", yaw_rates_.reference());
  status.addf("computation time (ms)", "%.1f", 1e3 * computation_time_);
  status.addf("of it refinement (ms)", "%.1f", 1e3 * refinement_time_);
  status.addf("waiting before (ms)", "%.1f", 1e3 * waiting_time_);
  status.addf("latency (ms)", "%.1f", 1e3 * latency_);
  status.addf("valid share", "%.3f", valid_share_);
  status.addf("dynamic share", "%.4f", mask_share_);
  status.addf("median of the score", "%.3f", median_);
  status.addf("MAD of the score", "%.3f", mad_);
  status.addf("threshold", "%.3f", threshold_);
  status.addf("flows waiting", "%zu", waiting_.size());
  status.addf("masks", "%zu", masks_);
  status.addf("flows dropped", "%zu", dropped_);
  status.add("last drop", drop_reason_);
  masks_since_report_ = dropped_since_report_ = 0;
  without_rotation_since_report_ = without_next_depth_since_report_ = without_past_since_report_ = 0;
  without_depth_std_since_report_ = 0;
}

}  // namespace radar_dot
