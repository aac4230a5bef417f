// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/MovingObjectsConfig.h"
#include "radar_dot/objects/mask_regions.h"
#include "radar_dot/objects/object_detection.h"
#include "radar_dot/objects/object_tracker.h"
#include "radar_dot/radar/returns_over_ground.h"

namespace radar_dot {

/// Parameters of the objects room as configured. What makes no sense is refused by validate().
OverGroundParams overGroundParams(const MovingObjectsConfig& config);
DetectionParams detectionParams(const MovingObjectsConfig& config);
ObjectTrackerParams objectTrackerParams(const MovingObjectsConfig& config);
MaskRegionParams maskRegionParams(const MovingObjectsConfig& config);

/// Of all of them. @throws std::invalid_argument naming the invalid parameter
void validate(const MovingObjectsConfig& config);

}  // namespace radar_dot
