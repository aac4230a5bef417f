// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "torch_backends.h"

namespace radar_dot {
namespace {

/// Whoever loads this library has its backends.
const bool kRegistered = [] {
  registerOpticalFlow("torch", makeTorchFlow);
  registerDepthEstimator("torch", makeTorchDepth);
  return true;
}();

}  // namespace
}  // namespace radar_dot
