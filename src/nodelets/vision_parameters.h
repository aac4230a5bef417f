// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovariance.h>

#include "radar_dot/DepthConfig.h"
#include "radar_dot/DynamicSegmentationConfig.h"
#include "radar_dot/OpticalFlowConfig.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot {

/// Parameters of the vision room as configured. What makes no sense is refused by the makers of the vision
/// room (makeOpticalFlow, makeDepthEstimator, validate).
OpticalFlowParams opticalFlowParams(const OpticalFlowConfig& config);
DepthParams depthParams(const DepthConfig& config);
/// @throws std::invalid_argument for a score that is not known
MotionParams motionParams(const DynamicSegmentationConfig& config);
MotionUncertainty motionUncertainty(const DynamicSegmentationConfig& config);
/// The same, or where a twist is less certain of its velocities or its yaw rate, as uncertain as it says.
/// What it does not observe stays as it is.
/// @param covariance    as in the message, (m/s)^2 and (rad/s)^2, row-major
/// @param has_rotation  a source of rotation tells the yaw, not the twist
MotionUncertainty motionUncertainty(const DynamicSegmentationConfig& config,
                                    const geometry_msgs::TwistWithCovariance::_covariance_type& covariance,
                                    bool has_rotation);

/// The name of the depth backend that takes an external depth.
inline constexpr const char* kTopicBackend = "topic";

}  // namespace radar_dot
