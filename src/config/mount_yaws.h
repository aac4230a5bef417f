// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "radar_dot/radar/sweep_estimator.h"

namespace radar_dot {

/// A YAML file of mount yaws by the names of radars: "radar_front: {yaw: 0.012, std: 0.002}".
/// @throws ConfigFileError (a std::runtime_error) naming file, line and what is wrong
std::map<std::string, MountYaw> readMountYaws(const std::string& path);

/// Replaces the file as a whole, or leaves it as it was.
/// @throws std::runtime_error naming the file, also for a value that could not be read back
void writeMountYaws(const std::string& path, const std::map<std::string, MountYaw>& yaws);

}  // namespace radar_dot
