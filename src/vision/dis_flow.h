// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "radar_dot/vision/optical_flow.h"

namespace radar_dot {

/// The backend "dis": OpenCV's Dense Inverse Search (Kroeger et al., ECCV 2016).
std::unique_ptr<OpticalFlow> makeDisFlow(const OpticalFlowParams& params);

}  // namespace radar_dot
