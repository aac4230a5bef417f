// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot {

/// The backends "torch": networks in TorchScript, run by libtorch.
/// @throws std::invalid_argument for a size that the network cannot have, and as TorchModel::load()
std::unique_ptr<OpticalFlow> makeTorchFlow(const OpticalFlowParams& params);
std::unique_ptr<DepthEstimator> makeTorchDepth(const DepthParams& params);

}  // namespace radar_dot
