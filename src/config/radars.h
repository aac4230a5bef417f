// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/config/sections.h"

namespace radar_dot {

constexpr const char* kRadars = "radars";

/// @throws InvalidParameter naming the entry, so that the others can be used
void validateRadars(const EgoVelocityConfig& config);

}  // namespace radar_dot
