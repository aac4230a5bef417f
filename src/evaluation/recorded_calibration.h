// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "radar_dot/bag/bag_input.h"
#include "radar_dot/evaluation/calibration_evaluation.h"

namespace radar_dot::evaluation {

/// The radars of a configuration in a recording, read as the nodelet reads them, in drives without gaps. What
/// is doubtful is told to `warn`.
/// @param references  topics of motion, or tf:FIXED_FRAME:FRAME (see recordedReference). The yaw rate is that
///                    of an IMU where one is among them. What stays zero is not measured.
/// @param tf          file of mounts that the recording lacks (see Transforms); empty: none
/// @throws InvalidParameter, std::runtime_error for topics, messages, transforms that are missing or of no
/// use
CalibrationData recordedCalibrationData(const bag::BagInput& input, const EgoVelocityConfig& config,
                                        const std::vector<std::string>& references, const std::string& tf,
                                        const std::function<void(const std::string&)>& warn,
                                        const std::function<void(double)>& progress = {});

}  // namespace radar_dot::evaluation
