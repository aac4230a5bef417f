// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovariance.h>

#include "radar_dot/vision/motion_refinement.h"

namespace radar_dot {

/// As configured, or where a twist is less certain of its velocities or its yaw rate, as uncertain as it
/// says. What it does not observe stays as it is.
/// @param covariance    as in the message, (m/s)^2 and (rad/s)^2, row-major
/// @param has_rotation  the yaw is known from a source of rotation instead of the twist
MotionUncertainty motionUncertainty(const MotionUncertainty& configured,
                                    const geometry_msgs::TwistWithCovariance::_covariance_type& covariance,
                                    bool has_rotation);

}  // namespace radar_dot
