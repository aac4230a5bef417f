// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include <Eigen/Geometry>
#include <string>

#include "nodelets/inputs/mask_history.h"

namespace radar_dot {

/// The motion of a pair, as velocities of the base frame in its own axes (m/s, rad/s) with their covariance,
/// at the stamp of the later image.
geometry_msgs::TwistWithCovarianceStamped refinedTwist(const PairInputs& pair,
                                                       const Eigen::Isometry3d& T_base_from_camera,
                                                       const std::string& base_frame);

}  // namespace radar_dot
