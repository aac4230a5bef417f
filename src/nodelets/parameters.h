// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <optional>
#include <string>
#include <vector>

#include "radar_dot/EgoVelocityConfig.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/velocity_filter.h"
#include "radar_dot/vision/mask_footprint.h"

namespace radar_dot {

/// One entry of the parameter `radars`.
struct RadarConfig {
  std::string name;
  std::string topic;
  std::optional<double> doppler_scale;  ///< none: the common one
  double mount_yaw_correction = 0.0;    ///< rad, added to the yaw of the mount from TF
};

/// Reads `radars`, a dictionary name -> {topic, doppler_scale, mount_yaw_correction}.
/// Entries that make no sense are left out; `problems` gets one line for each of them.
std::vector<RadarConfig> radarsFromParameter(XmlRpc::XmlRpcValue& radars, std::vector<std::string>& problems);

/// "0, 4" -> {0, 4}; "" -> {}. @throws std::invalid_argument naming the parameter.
std::vector<int> stateList(const std::string& text, const std::string& parameter);

/// Turns the value of a state list that was written as a number or a list (0, [0, 4]) into the
/// text that dynamic_reconfigure wants. None: the value is a text already, or no state list.
std::optional<std::string> stateListText(XmlRpc::XmlRpcValue& value);

/// Extraction as configured, with the common doppler_scale. @throws std::invalid_argument.
ExtractionParams extractionParams(const EgoVelocityConfig& config);

/// Estimator and segmentation as configured. @throws std::invalid_argument.
EgoVelocityParams estimatorParams(const EgoVelocityConfig& config);

/// Filter over sweeps as configured. @throws std::invalid_argument.
VelocityFilterParams filterParams(const EgoVelocityConfig& config);

/// The column that a return stands for in a mask, as configured. @throws std::invalid_argument.
MaskFootprint maskFootprint(const EgoVelocityConfig& config);

/// A configuration in which what made no sense has been replaced by its default.
struct MendedConfig {
  EgoVelocityConfig config;
  std::vector<std::string> problems;  ///< one line per replaced parameter
  bool valid = true;                  ///< extractionParams and estimatorParams accept `config`
  bool usable = true;                 ///< and no velocity of the wrong sign can come of the replacement
};
/// Checks every parameter (or pair that belongs together) by itself.
MendedConfig mendedConfig(const EgoVelocityConfig& config);

/// A private parameter that must be finite and positive; else one error line, and the default.
double positiveParameter(const ros::NodeHandle& private_handle, const std::string& name,
                         double default_value);

}  // namespace radar_dot
