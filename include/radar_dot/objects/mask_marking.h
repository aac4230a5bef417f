// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "radar_dot/common/twist_history.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/vision/mask_footprint.h"

namespace radar_dot {

/// The mask's half of the loop between mask and velocity: sets RadarScan::known_dynamic to the returns that
/// lie in a mask. They are brought to the time of the mask as points of a static world; those that move
/// independently have moved on since, which the limit on the age keeps small.
/// @param max_age  s, of the mask at the time of the scan, which it must not be later than; a velocity holds
///                 as long
/// @return why the mask does not tell, and nothing is set; empty where it does
/// @throws std::invalid_argument for a mask that does not fit its camera
std::string markReturns(RadarScan& scan, const StampedMask& mask, double max_age,
                        const MaskFootprint& footprint, const TwistHistory& velocities);

}  // namespace radar_dot
