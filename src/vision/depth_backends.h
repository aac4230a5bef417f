// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "radar_dot/vision/depth_estimator.h"

namespace radar_dot {

/// Ground plane, radar returns as upright columns, and a background in their directions.
std::unique_ptr<DepthEstimator> makeRadarGroundDepth(const DepthParams& params);

/// MotionDepth from radar_ground on.
std::unique_ptr<DepthEstimator> makeMotionDepth(const DepthParams& params);

/// A projected lidar sweep, its gaps closed.
std::unique_ptr<DepthEstimator> makeLidarDepth(const DepthParams& params);

}  // namespace radar_dot
