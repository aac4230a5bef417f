// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <ros/time.h>

#include <string>

#include "radar_dot/EgoStatus.h"
#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// The velocity of a result: m/s and rad/s, in `base_frame`, with its covariance.
geometry_msgs::TwistWithCovarianceStamped twistMessage(const ros::Time& stamp, const std::string& base_frame,
                                                       const EgoVelocityResult& result);

/// The twist of a message.
StampedTwist twistOf(const geometry_msgs::TwistWithCovarianceStamped& message);
/// Why a twist cannot be used: another frame than the base frame, not finite. Empty when it can.
std::string twistDefect(const geometry_msgs::TwistWithCovarianceStamped& message,
                        const std::string& base_frame);

/// Outcome, counts and quality of a result. Without what the estimator does not know: reason of the caller,
/// counts of radars and of returns before the filters, computation time.
EgoStatus statusMessage(const ros::Time& stamp, const std::string& base_frame,
                        const EgoVelocityParams& params, const EgoVelocityResult& result);

}  // namespace radar_dot
