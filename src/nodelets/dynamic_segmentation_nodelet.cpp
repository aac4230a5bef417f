// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/dynamic_segmentation_nodelet.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "nodelets/common/process_clock.h"
#include "vision/resize_nearest.h"

namespace radar_dot {

void DynamicSegmentationNodelet::setUp() {
  describe("segmentation", config_.stream);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [this] { processQueue(); }, [this](const std::string& text) { warn("rotation", text); },
      true);
  const auto warn_of_sensor = [this](const std::string& text) { warn("sensor", text); };
  static_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  dynamic_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  setUpOutputs();
  setUpInputs();
  try {
    motion_->setUpRotation(config_.rotation, getNodeHandle());
  } catch (const std::invalid_argument& error) {
    reportProblem(std::string(error.what()) + "; using the yaw rate of the twists");
  }
}

void DynamicSegmentationNodelet::setUpInputs() {
  using sensor_msgs::Image;
  flow_input_ = &listen<Flow>("flow", 3, [this](const FlowConstPtr& flow) { onFlow(flow); });
  depth_input_ = &listen<Image>("depth", 5, [this](const sensor_msgs::ImageConstPtr& depth) {
    waiting_.addDepth(depth);
    processQueue();
  });
  camera_input_ = &listenToCamera(camera_);
  twist_input_ = &listenToTwists(*motion_);
  listenToClouds("radar/static", *static_returns_,
                 {false, [this] { return config_.motion.radar.static_gain > 0.0; },
                  [this] { static_returns_->clear(); }});
  listenToClouds("radar/dynamic", *dynamic_returns_,
                 {false, [this] { return config_.motion.radar.dynamic_gain > 0.0; },
                  [this] { dynamic_returns_->clear(); }});
  backward_input_ = &listen<Flow>(
      "flow/backward", 3,
      [this](const FlowConstPtr& flow) {
        pipeline_.addBackward(flow->header.stamp.toSec(), flow->second_stamp.toSec(), flowOf(*flow));
      },
      {false, [this] { return config_.usesBackwardFlow() || wantsMotionDepth(); }, {}});
  depth_std_input_ = &listen<Image>(
      "depth/uncertainty", 5, [this](const sensor_msgs::ImageConstPtr& std) { waiting_.addDepthStd(std); },
      {false, [this] { return config_.usesDepthUncertainty(); }, [this] { waiting_.clearDepthStds(); }});
}

void DynamicSegmentationNodelet::setUpOutputs() {
  ros::NodeHandle& handle = getNodeHandle();
  transport_ = std::make_unique<image_transport::ImageTransport>(handle);
  mask_publisher_ = transport_->advertise("dynamic/mask", 3);
  valid_publisher_ = transport_->advertise("dynamic/valid", 3);
  score_publisher_ = handle.advertise<sensor_msgs::Image>("dynamic/score", 3);
  expected_flow_publisher_ = handle.advertise<sensor_msgs::Image>("dynamic/expected_flow", 3);
  refined_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist_refined", 3);
  residual_publisher_ = handle.advertise<sensor_msgs::Image>("dynamic/residual", 3);
  motion_depth_publisher_ = handle.advertise<sensor_msgs::Image>("depth/motion", 3);
  motion_depth_std_publisher_ = handle.advertise<sensor_msgs::Image>("depth/motion/uncertainty", 3);
}

void DynamicSegmentationNodelet::apply(const DynamicSegmentationConfig& config) {
  pipeline_.configure(config);
  config_ = config;
}

void DynamicSegmentationNodelet::clearHistory() {
  waiting_.clear();
  pipeline_.clear();
  yaw_rates_.reset();
  motion_->forget();
  static_returns_->clear();
  dynamic_returns_->clear();
}

bool DynamicSegmentationNodelet::hasAudience() const {
  return mask_publisher_.getNumSubscribers() + valid_publisher_.getNumSubscribers() +
                 score_publisher_.getNumSubscribers() + expected_flow_publisher_.getNumSubscribers() +
                 residual_publisher_.getNumSubscribers() + refined_publisher_.getNumSubscribers() >
             0 ||
         wantsMotionDepth();
}

bool DynamicSegmentationNodelet::wantsMotionDepth() const {
  return motion_depth_publisher_.getNumSubscribers() + motion_depth_std_publisher_.getNumSubscribers() > 0;
}

void DynamicSegmentationNodelet::drop(const std::string& reason) {
  ++dropped_;
  ++dropped_since_report_;
  drop_reason_ = reason;
  warn("dropped", "no mask: " + reason);
}

void DynamicSegmentationNodelet::onFlow(const FlowConstPtr& flow) {
  if (flow->second_stamp.isZero() || flow->second_stamp == flow->header.stamp) {
    throw std::invalid_argument("second_stamp: it must be given, and differ from the stamp of the header");
  }
  waiting_.addFlow(flow, Moment::now());
  processQueue();
}

void DynamicSegmentationNodelet::processQueue() {
  const WaitingPairs::Needs needs{config_.usesNextDepth(), config_.usesDepthUncertainty(),
                                  config_.input_timeout, depth_input_->topic()};
  for (;;) {
    Inputs inputs;
    std::optional<WaitingPairs::Taken> taken =
        waiting_.take(needs, Moment::now(), [&](const WaitingPairs::Pair& messages, double waited) {
          return findMotion(messages, waited, inputs);
        });
    if (!taken) return;
    if (!taken->missing.empty()) {
      drop(taken->missing);
      continue;
    }
    inputs.messages = std::move(taken->item);
    waiting_time_ = Moment::now().wall - taken->arrival.wall;
    try {
      placeOnGrid(inputs);
      addRadarPoints(inputs);
      segment(inputs);
    } catch (const std::exception& error) {
      // A flow that does not fit must not block those behind it.
      drop(error.what());
    }
  }
}

std::string DynamicSegmentationNodelet::findMotion(const WaitingPairs::Pair& messages, double waited,
                                                   Inputs& inputs) {
  if (!camera_) return "nothing on '" + camera_input_->topic() + "' yet";
  const Flow& flow = *messages.flow;
  std::string missing;
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookupCamera(flow.header.frame_id, missing);
  if (!T_base_from_camera) return missing;
  const IntervalMotion motion = motion_->between(flow.header.stamp, flow.second_stamp, config_.max_twist_age,
                                                 waited < config_.rotation_timeout);
  if (!motion.T_begin_from_end)
    return "no motion of the vehicle from '" + twist_input_->topic() + "': " + motion.missing;
  inputs.without_rotation = motion.without_rotation;
  MaskPair& pair = inputs.pair;
  pair.first_time = flow.header.stamp.toSec();
  pair.second_time = flow.second_stamp.toSec();
  pair.T_base_from_camera = *T_base_from_camera;
  pair.T_first_from_second = *motion.T_begin_from_end;
  const bool has_rotation = motion_->hasRotation() && !motion.without_rotation;
  pair.motion_uncertainty =
      motionUncertainty(config_.motion_uncertainty, motion_->latestCovariance(), has_rotation);
  return {};
}

void DynamicSegmentationNodelet::placeOnGrid(Inputs& inputs) const {
  const WaitingPairs::Pair& messages = inputs.messages;
  const Flow& flow = *messages.flow;
  MaskPair& pair = inputs.pair;
  const CameraIntrinsics camera = cameraOf(*camera_);
  const cv::Size image(camera.width, camera.height);
  if (flow.image_width != static_cast<std::uint32_t>(image.width) ||
      flow.image_height != static_cast<std::uint32_t>(image.height)) {
    throw std::invalid_argument("flow on '" + flow_input_->topic() + "' is of images of " +
                                std::to_string(flow.image_width) + " x " + std::to_string(flow.image_height) +
                                " px, camera_info on '" + camera_input_->topic() + "' of " + sizeText(image) +
                                " px (with its roi and binning)");
  }
  pair.flow = radar_dot::flowOf(flow);
  const cv::Size grid = pair.flow.flow.size();
  pair.camera = camera.scaledTo(grid.width, grid.height);
  pair.pixel_scale = static_cast<double>(image.width) / grid.width;
  const auto place = [&](const cv::Mat& depth, const InputMonitor& input) {
    if (!isGridOf(depth.size(), image)) {
      throw std::invalid_argument("depth on '" + input.topic() + "' of " + sizeText(depth.size()) +
                                  " px does not have the shape of the camera's image of " + sizeText(image) +
                                  " px");
    }
    return resizeNearest(depth, grid);
  };
  pair.depth = place(radar_dot::depthOf(*messages.depth), *depth_input_);
  if (messages.next_depth) pair.next_depth = place(radar_dot::depthOf(*messages.next_depth), *depth_input_);
  if (messages.depth_std) pair.depth_std = place(depthStdOf(*messages.depth_std), *depth_std_input_);
  pair.wants_motion_depth = wantsMotionDepth();
}

void DynamicSegmentationNodelet::addRadarPoints(Inputs& inputs) {
  const ros::Time& stamp = inputs.messages.flow->header.stamp;
  if (config_.motion.radar.dynamic_gain > 0.0)
    inputs.pair.dynamic_points = dynamic_returns_->at(stamp, config_.radar_max_age, &config_.ground);
  if (config_.motion.radar.static_gain > 0.0)
    inputs.pair.static_points = static_returns_->at(stamp, config_.radar_max_age);
}

void DynamicSegmentationNodelet::segment(const Inputs& inputs) {
  const ros::WallTime start = ProcessClock::now();
  const MaskOutcome outcome = pipeline_.process(inputs.pair);
  const MotionResult& result = outcome.result;
  computation_time_ = (ProcessClock::now() - start).toSec();
  refinement_time_ = ProcessClock::isRecorded() ? 0.0 : outcome.refinement_seconds;
  publish(inputs, outcome);
  if (config_.looksBack() && !outcome.looked_back) ++without_past_since_report_;

  latency_ = since(ros::Time(std::max(inputs.pair.first_time, inputs.pair.second_time)));
  const auto total = static_cast<double>(result.mask.total());
  valid_share_ = static_cast<double>(result.valid_count) / total;
  mask_share_ = cv::countNonZero(result.mask) / total;
  median_ = result.median;
  mad_ = result.mad;
  threshold_ = result.threshold;
  ++masks_;
  ++masks_since_report_;
  noteOutput();
  if (config_.usesNextDepth() && !inputs.messages.next_depth) ++without_next_depth_since_report_;
  if (config_.usesDepthUncertainty() && !inputs.messages.depth_std) ++without_depth_std_since_report_;
  if (inputs.without_rotation) {
    ++without_rotation_since_report_;
    warn("rotation", "no rotation at the stamps of the images from " + motion_->rotationText() +
                         "; using the rates of the twists");
  }
  if (result.valid_count == 0) {
    warn("valid", "the mask is empty: no pixel has both depth on '" + depth_input_->topic() +
                      "' and flow on '" + flow_input_->topic() + "'");
  }
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::DynamicSegmentationNodelet, nodelet::Nodelet)
