// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluation/recorded_transforms.h"
#include "radar_dot/bag/bag_input.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/evaluation/motion_comparison.h"

namespace radar_dot::evaluation {

/// The type of a reference of recordedReference that tells the yaw rate alone.
inline constexpr char kImuType[] = "sensor_msgs/Imu";

/// What of a recording is compared with what.
struct RecordingOptions {
  std::string twist = "/ego/twist", odometry = "/odom", reference;
  std::string estimate_frame, reference_frame;
  std::string keyframes;
  std::string masks = "/dynamic/mask", mask_truth = "/ground_truth/dynamic_mask/compressed";
  std::string objects = "/dynamic/objects", object_truth = "/ground_truth/boxes";
  std::string static_returns = "/radar/static", dynamic_returns = "/radar/dynamic";
  ObjectMatching matching;
  ComparisonOptions comparison;
  void describe(FieldList& fields);
};

/// Evaluates a recording. What is doubtful is told to `warn`.
/// @throws InvalidParameter for a topic that is not in the recording or not of a fitting type, with those
/// that are;
///         std::runtime_error where nothing can be compared
MotionReport evaluateRecording(const bag::BagInput& input, const RecordingOptions& options,
                               const std::function<void(const std::string&)>& warn,
                               const std::function<void(double)>& progress = {});

/// The motion of a frame as a topic, also of sensor_msgs/Imu, or tf:FIXED_FRAME:FRAME tells it.
/// @throws InvalidParameter as evaluateRecording
RecordedMotion recordedReference(const bag::BagInput& input, const std::string& name, const std::string& base,
                                 const Transforms& transforms,
                                 const std::function<void(const std::string&)>& warn);

/// The topic that an option names, with its slash.
/// @throws InvalidParameter where it is not there or not of one of the types, with those that are
std::string checkedTopic(const bag::BagInput& input, const std::string& option, const std::string& topic,
                         const std::vector<std::string>& types);

}  // namespace radar_dot::evaluation
