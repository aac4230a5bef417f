// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include "radar_dot/common/stamped_twist.h"
#include "radar_dot/vision/mask_pipeline.h"

namespace radar_dot {

/// The refined motion of a pair, as velocities of the base frame in its own axes with their covariance, at
/// the later image.
StampedTwist refinedVelocity(const MaskPair& pair, const MotionInput& refined);

/// The same in a message with this header: the base frame, at the later image.
geometry_msgs::TwistWithCovarianceStamped refinedTwist(const StampedTwist& velocity,
                                                       const std_msgs::Header& header);

}  // namespace radar_dot
