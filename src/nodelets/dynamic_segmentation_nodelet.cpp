// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/dynamic_segmentation_nodelet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "nodelets/inputs/twist_uncertainty.h"
#include "nodelets/messages/refined_twist.h"
#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/rigid_motion.h"
#include "vision/resize_nearest.h"

namespace radar_dot {
namespace {

constexpr std::size_t kMaxWaiting = 4;   // flows; at 12 Hz a third of a second
constexpr double kWaitingPeriod = 0.05;  // s, how often waiting flows are looked at

}  // namespace

void DynamicSegmentationNodelet::onInit() {
  const GivenConfig<DynamicSegmentationConfig> given =
      readConfig<DynamicSegmentationConfig>(getPrivateNodeHandle());
  config_ = given.config;
  setUp("segmentation", config_.stream);
  ros::NodeHandle& handle = getNodeHandle();
  extrinsics_ = std::make_unique<Extrinsics>(config_.stream.base_frame, handle);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [this] { processQueue(); }, [this](const std::string& text) { warn("rotation", text); },
      true);
  const auto warn_of_sensor = [this](const std::string& text) { warn("sensor", text); };
  static_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  dynamic_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  setUpOutputs();
  flow_input_ = &addInput("flow");
  depth_input_ = &addInput("depth");
  camera_input_ = &addInput("camera_info");
  twist_input_ = &addInput("ego/twist");
  static_input_ = &addInput("radar/static", false);
  dynamic_input_ = &addInput("radar/dynamic", false);
  backward_input_ = &addInput("flow/backward", false);
  depth_std_input_ = &addInput("depth/uncertainty", false);
  try {
    motion_->setUpRotation(config_.rotation, handle);
  } catch (const std::invalid_argument& error) {
    reportProblem(std::string(error.what()) + "; using the yaw rate of the twists");
  }
  serve<DynamicSegmentationConfig>(given, [this](const DynamicSegmentationConfig& config) { apply(config); });
  connectWhile([this] { return wanted(); }, [this] { connect(); }, [this] { disconnect(); });
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
}

void DynamicSegmentationNodelet::connect() {
  connected_since_ = ros::WallTime::now();
  flow_subscriber_ =
      listen<Flow>(*flow_input_, "flow", 3, [this](const FlowConstPtr& flow) { onFlow(flow); });
  depth_subscriber_ =
      listen<sensor_msgs::Image>(*depth_input_, "depth", 5, [this](const sensor_msgs::ImageConstPtr& depth) {
        depths_.add(depth);
        processQueue();
      });
  camera_subscriber_ = listenToCamera(*camera_input_, camera_);
  twist_subscriber_ = listenToTwists(*twist_input_, *motion_);
  waiting_timer_ = getNodeHandle().createWallTimer(ros::WallDuration(kWaitingPeriod),
                                                   [this](const ros::WallTimerEvent&) { processQueue(); });
  updateSubscriptions();
}

void DynamicSegmentationNodelet::disconnect() {
  waiting_timer_.stop();
  stop(*flow_input_, flow_subscriber_);
  stop(*depth_input_, depth_subscriber_);
  stop(*camera_input_, camera_subscriber_);
  stop(*twist_input_, twist_subscriber_);
  updateSubscriptions();
  clearHistory();
}

void DynamicSegmentationNodelet::apply(const DynamicSegmentationConfig& config) {
  if (!sameFields(segmenter_.params(), config.motion)) segmenter_ = MotionSegmenter(config.motion);
  if (!sameEvidence(config_, config)) history_.clear();
  config_ = config;
  updateSubscriptions();
}

void DynamicSegmentationNodelet::updateSubscriptions() {
  updateRadarSubscription(*static_input_, static_subscriber_, "radar/static", *static_returns_,
                          config_.motion.static_gain);
  updateRadarSubscription(*dynamic_input_, dynamic_subscriber_, "radar/dynamic", *dynamic_returns_,
                          config_.motion.radar_gain);
  updateBackwardSubscription();
  updateUncertaintySubscription();
}

void DynamicSegmentationNodelet::updateRadarSubscription(InputMonitor& input, ros::Subscriber& subscriber,
                                                         const char* topic, RecentClouds& clouds,
                                                         double gain) {
  const bool listening = static_cast<bool>(subscriber);
  const bool wanted = connected() && gain > 0.0;
  if (wanted && !listening) {
    subscriber = listenToClouds(input, topic, clouds);
  } else if (!wanted && listening) {
    stop(input, subscriber);
    clouds.clear();
  }
}

void DynamicSegmentationNodelet::updateBackwardSubscription() {
  const bool listening = static_cast<bool>(backward_subscriber_);
  const bool wanted = connected() && (config_.looksBack() || config_.remembers());
  if (wanted && !listening) {
    backward_subscriber_ = listen<Flow>(*backward_input_, "flow/backward", 3,
                                        [this](const FlowConstPtr& flow) { history_.addBackward(flow); });
  } else if (!wanted && listening) {
    stop(*backward_input_, backward_subscriber_);
  }
}

void DynamicSegmentationNodelet::updateUncertaintySubscription() {
  const bool listening = static_cast<bool>(depth_std_subscriber_);
  const bool wanted = connected() && config_.usesDepthUncertainty();
  if (wanted && !listening) {
    depth_std_subscriber_ =
        listen<sensor_msgs::Image>(*depth_std_input_, "depth/uncertainty", 5,
                                   [this](const sensor_msgs::ImageConstPtr& std) { depth_stds_.add(std); });
  } else if (!wanted && listening) {
    stop(*depth_std_input_, depth_std_subscriber_);
    depth_stds_.clear();
  }
}

void DynamicSegmentationNodelet::clearHistory() {
  waiting_.clear();
  history_.clear();
  depths_.clear();
  depth_stds_.clear();
  motion_->forget();
  static_returns_->clear();
  dynamic_returns_->clear();
}

bool DynamicSegmentationNodelet::wanted() const {
  return mask_publisher_.getNumSubscribers() + valid_publisher_.getNumSubscribers() +
             score_publisher_.getNumSubscribers() + expected_flow_publisher_.getNumSubscribers() +
             residual_publisher_.getNumSubscribers() + refined_publisher_.getNumSubscribers() >
         0;
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
  waiting_.push_back({flow, ros::WallTime::now(), {}, {}});
  processQueue();
}

void DynamicSegmentationNodelet::processQueue() {
  while (!waiting_.empty()) {
    WaitingFlow& front = waiting_.front();
    Inputs inputs;
    std::string missing;
    Availability availability = Availability::kImpossible;
    try {
      availability = gather(front, inputs, missing);
      const bool within_timeout = (ros::WallTime::now() - front.arrival).toSec() < config_.input_timeout;
      if (availability == Availability::kPending && within_timeout && waiting_.size() <= kMaxWaiting) return;
      waiting_.pop_front();
      if (availability == Availability::kComplete) {
        segment(inputs);
      } else {
        drop(missing);
      }
    } catch (const std::exception& error) {
      // A flow that does not fit must not block those behind it.
      if (!waiting_.empty() && waiting_.front().message == inputs.flow) waiting_.pop_front();
      drop(error.what());
    }
  }
}

DynamicSegmentationNodelet::Availability DynamicSegmentationNodelet::gatherDepths(WaitingFlow& waiting,
                                                                                  std::string& missing) {
  const ros::Time first = waiting.message->header.stamp;
  const ros::Time second = waiting.message->second_stamp;
  if (!waiting.depth) waiting.depth = depths_.find(first);
  if (!waiting.depth) {
    missing = "no depth on '" + depth_input_->topic() + "' at the time of the flow's first image";
    return depths_.isPast(first) ? Availability::kImpossible : Availability::kPending;
  }
  if (!config_.usesNextDepth()) return Availability::kComplete;
  if (!waiting.next_depth) waiting.next_depth = depths_.find(second);
  if (waiting.next_depth || depths_.isPast(second)) return Availability::kComplete;
  missing = "no depth on '" + depth_input_->topic() + "' at the time of the flow's second image";
  // The flow alone can tell as well.
  const bool within_timeout = (ros::WallTime::now() - waiting.arrival).toSec() < config_.input_timeout;
  return within_timeout && waiting_.size() <= kMaxWaiting ? Availability::kPending : Availability::kComplete;
}

DynamicSegmentationNodelet::Availability DynamicSegmentationNodelet::gather(WaitingFlow& waiting,
                                                                            Inputs& inputs,
                                                                            std::string& missing) {
  inputs.flow = waiting.message;
  const Availability depths = gatherDepths(waiting, missing);
  if (depths != Availability::kComplete) return depths;
  inputs.depth = waiting.depth;
  inputs.next_depth = waiting.next_depth;
  // It is sent just before its depth, so that it is there or lost.
  if (config_.usesDepthUncertainty()) inputs.depth_std = depth_stds_.find(inputs.flow->header.stamp);
  if (!camera_) {
    missing = "nothing on '" + camera_input_->topic() + "' yet";
    return Availability::kPending;
  }
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookup(inputs.flow->header.frame_id, missing);
  if (!T_base_from_camera) return Availability::kPending;
  const bool within_timeout = (ros::WallTime::now() - waiting.arrival).toSec() <
                                  std::min(config_.rotation_timeout, config_.input_timeout) &&
                              waiting_.size() <= kMaxWaiting;
  const EgoMotion::Answer motion = motion_->between(inputs.flow->header.stamp, inputs.flow->second_stamp,
                                                    config_.max_twist_age, within_timeout);
  if (!motion.T_begin_from_end) {
    missing = "no motion of the vehicle from '" + twist_input_->topic() + "': " + motion.missing;
    return Availability::kPending;
  }
  inputs.without_rotation = motion.without_rotation;
  inputs.T_base_from_camera = *T_base_from_camera;
  inputs.motion.T_current_from_previous = staticPointMotion(*T_base_from_camera, *motion.T_begin_from_end);
  if (config_.byUncertainty() || config_.refine) {
    const double dt = (inputs.flow->second_stamp - inputs.flow->header.stamp).toSec();
    const bool has_rotation = motion_->hasRotation() && !motion.without_rotation;
    const MotionUncertainty uncertainty =
        motionUncertainty(config_.motion_uncertainty, motion_->latestCovariance(), has_rotation);
    inputs.motion.motion_covariance =
        cameraCovariance(*T_base_from_camera, baseMotionCovariance(uncertainty, std::abs(dt)));
  }
  placeOnGrid(inputs);
  addRadarPoints(inputs);
  return Availability::kComplete;
}

void DynamicSegmentationNodelet::placeOnGrid(Inputs& inputs) const {
  const Flow& flow = *inputs.flow;
  MotionInput& motion = inputs.motion;
  const CameraIntrinsics camera = cameraOf(*camera_);
  const cv::Size image(camera.width, camera.height);
  if (flow.image_width != camera_->width || flow.image_height != camera_->height) {
    throw std::invalid_argument("flow on '" + flow_input_->topic() + "' is of images of " +
                                std::to_string(flow.image_width) + " x " + std::to_string(flow.image_height) +
                                " px, camera_info on '" + camera_input_->topic() + "' of " + sizeText(image) +
                                " px");
  }
  const FlowField field = radar_dot::flowOf(flow);
  const cv::Size grid = field.flow.size();
  motion.flow = field.flow;
  // The forward-backward error is noise to this score, and no reason to leave a pixel out.
  if (config_.byUncertainty() && !field.fb_error.empty()) {
    motion.fb_error = field.fb_error;
  } else {
    motion.flow_valid = field.valid;
  }
  motion.camera = camera.scaledTo(grid.width, grid.height);
  motion.pixel_scale = static_cast<double>(image.width) / grid.width;
  const auto place = [&](const cv::Mat& depth, const InputMonitor& input) {
    if (!isGridOf(depth.size(), image)) {
      throw std::invalid_argument("depth on '" + input.topic() + "' of " + sizeText(depth.size()) +
                                  " px does not have the shape of the camera's image of " + sizeText(image) +
                                  " px");
    }
    return resizeNearest(depth, grid);
  };
  motion.depth = place(radar_dot::depthOf(*inputs.depth), *depth_input_);
  if (inputs.next_depth) motion.next_depth = place(radar_dot::depthOf(*inputs.next_depth), *depth_input_);
  if (inputs.depth_std) motion.depth_std = place(depthStdOf(*inputs.depth_std), *depth_std_input_);
}

void DynamicSegmentationNodelet::addRadarPoints(Inputs& inputs) {
  const ros::Time& stamp = inputs.flow->header.stamp;
  const Eigen::Isometry3f T_camera_from_base = inputs.T_base_from_camera.inverse().cast<float>();
  if (config_.motion.radar_gain > 0.0) {
    for (const CloudPoint& point : dynamic_returns_->at(stamp, config_.radar_max_age)) {
      // Returns that only a mask called dynamic must not confirm that mask. Without the field: all of them.
      const bool own_motion = std::isnan(point.residual) ||
                              std::abs(point.residual) >= static_cast<float>(config_.radar_min_residual);
      if (own_motion) inputs.motion.dynamic_points.emplace_back(T_camera_from_base * point.position);
    }
  }
  if (config_.motion.static_gain > 0.0) {
    for (const CloudPoint& point : static_returns_->at(stamp, config_.radar_max_age))
      inputs.motion.static_points.emplace_back(T_camera_from_base * point.position);
  }
}

void DynamicSegmentationNodelet::refine(Inputs& inputs) {
  std::optional<GroundPlane> ground;
  if (config_.refine_ground) ground = GroundPlane{inputs.T_base_from_camera, config_.ground};
  refineInput(inputs.motion, ground, config_.motion.max_depth, config_.motion.noise, config_.refinement);
  if (refined_publisher_.getNumSubscribers() > 0) {
    refined_publisher_.publish(refinedTwist(inputs, inputs.T_base_from_camera, config_.stream.base_frame));
  }
}

const MotionResult& DynamicSegmentationNodelet::maskOf(Inputs& inputs) {
  std::optional<MotionInput> before;
  if (config_.looksBack()) {
    before = history_.previousPair(inputs);
    if (!before) ++without_past_since_report_;
  }
  if (config_.remembers()) inputs.motion.belief = history_.beliefFor(inputs, config_.memory);
  const MotionResult& result = segmenter_.segment(inputs.motion, before ? &*before : nullptr);
  if (config_.looksBack() || config_.remembers()) history_.remember(inputs, result);
  return result;
}

void DynamicSegmentationNodelet::segment(Inputs& inputs) {
  if (isDistorted(*camera_)) {
    warn("camera", "camera_info on '" + camera_input_->topic() +
                       "' has distortion: the images must be rectified (image_proc)");
  }
  const ros::WallTime start = ros::WallTime::now();
  if (config_.refine) refine(inputs);
  const MotionResult& result = maskOf(inputs);
  computation_time_ = (ros::WallTime::now() - start).toSec();
  publish(inputs, result);

  latency_ =
      ros::Time::now().toSec() - std::max(inputs.flow->header.stamp, inputs.flow->second_stamp).toSec();
  const auto total = static_cast<double>(result.mask.total());
  valid_share_ = static_cast<double>(result.valid_count) / total;
  mask_share_ = cv::countNonZero(result.mask) / total;
  median_ = result.median;
  mad_ = result.mad;
  threshold_ = result.threshold;
  ++masks_;
  ++masks_since_report_;
  last_mask_ = ros::WallTime::now();
  if (config_.usesNextDepth() && !inputs.next_depth) ++without_next_depth_since_report_;
  if (config_.usesDepthUncertainty() && !inputs.depth_std) ++without_depth_std_since_report_;
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
