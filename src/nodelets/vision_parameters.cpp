// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vision_parameters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "twist_history.h"

namespace radar_dot {
namespace {

template <typename Config>
NetworkParams networkParams(const Config& config) {
  NetworkParams params;
  params.model = config.model;
  params.device = config.device;
  params.threads = config.threads;
  return params;
}

}  // namespace

OpticalFlowParams opticalFlowParams(const OpticalFlowConfig& config) {
  OpticalFlowParams params;
  params.backend = config.backend;
  params.working_width = config.working_width;
  params.preset = config.preset;
  params.initialisation = config.initialisation;
  params.forward_backward = config.forward_backward;
  params.forward_backward_absolute = config.forward_backward_absolute;
  params.forward_backward_relative = config.forward_backward_relative;
  params.network = networkParams(config);
  params.network_width = config.network_width;
  params.network_height = config.network_height;
  return params;
}

DepthParams depthParams(const DepthConfig& config) {
  DepthParams params;
  params.backend = config.backend;
  params.max_depth = config.max_depth;
  params.ground_pitch = config.ground_pitch;
  params.ground_height = config.ground_height;
  params.column_height = config.column_height;
  params.column_half_width = config.column_half_width;
  params.azimuth_std = config.azimuth_std;
  params.image_edges = config.image_edges;
  params.background_depth = config.background_depth;
  params.background_angle = config.background_angle;
  params.relative_std = config.relative_std;
  params.ground_pitch_std = config.ground_pitch_std;
  params.ground_height_std = config.ground_height_std;
  params.ground_relative_std = config.ground_relative_std;
  params.column_std = config.column_std;
  params.background_std = config.background_std;
  params.lidar_std = config.lidar_std;
  params.completion_std = config.completion_std;
  params.completion_kernel = config.completion_kernel;
  params.network = networkParams(config);
  return params;
}

MotionParams motionParams(const DynamicSegmentationConfig& config) {
  MotionParams params;
  if (config.score != "paper" && config.score != "uncertainty")
    throw std::invalid_argument("score '" + config.score + "' is not one of paper, uncertainty");
  params.score = config.score == "paper" ? MotionScore::kPaper : MotionScore::kUncertainty;
  params.flow_std = config.flow_std;
  params.flow_std_relative = config.flow_std_relative;
  params.fb_error_weight = config.fb_error_weight;
  params.depth_std = config.depth_std;
  params.next_depth_std = config.next_depth_std;
  params.false_alarm = config.false_alarm;
  params.min_scale = config.min_scale;
  params.seed = config.seed;
  params.radar_azimuth_std = config.radar_azimuth_std;
  params.k = config.k;
  params.lambda = config.lambda;
  params.min_depth = config.min_depth;
  params.foe_std = config.foe_std;
  params.occlusion_margin = config.occlusion_margin;
  params.max_depth = config.max_depth;
  params.opening = config.opening;
  params.closing = config.closing;
  params.min_threshold = config.min_threshold;
  params.predicted_in_view = config.predicted_in_view;
  params.radar_gain = config.radar_gain;
  params.radar_radius = config.radar_radius;
  return params;
}

MotionUncertainty motionUncertainty(const DynamicSegmentationConfig& config) {
  MotionUncertainty uncertainty;
  uncertainty.forward_velocity_std = config.forward_velocity_std;
  uncertainty.lateral_velocity_std = config.lateral_velocity_std;
  uncertainty.vertical_velocity_std = config.vertical_velocity_std;
  uncertainty.yaw_rate_std = config.yaw_rate_std;
  uncertainty.tilt_std = config.tilt_std;
  return uncertainty;
}

MotionUncertainty motionUncertainty(const DynamicSegmentationConfig& config,
                                    const geometry_msgs::TwistWithCovariance::_covariance_type& covariance,
                                    bool has_rotation) {
  MotionUncertainty uncertainty = motionUncertainty(config);
  const auto widen = [&covariance](std::size_t axis, double& deviation) {
    constexpr std::size_t kAxes = 6;
    const double variance = covariance[axis * kAxes + axis];
    if (variance < kUnobservedVariance) deviation = std::max(deviation, std::sqrt(std::max(variance, 0.0)));
  };
  constexpr std::size_t kForward = 0, kLateral = 1, kVertical = 2, kYaw = 5;
  widen(kForward, uncertainty.forward_velocity_std);
  widen(kLateral, uncertainty.lateral_velocity_std);
  widen(kVertical, uncertainty.vertical_velocity_std);
  if (!has_rotation) widen(kYaw, uncertainty.yaw_rate_std);
  return uncertainty;
}

}  // namespace radar_dot
