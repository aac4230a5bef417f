// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "parameters.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "config_mending.h"

namespace radar_dot {
namespace {

using XmlRpc::XmlRpcValue;

// dynamic_reconfigure has no "no limit": the end of the range stands for it.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double lowerLimit(double value, double lowest) { return value <= lowest ? -kInfinity : value; }
double upperLimit(double value, double highest) { return value >= highest ? kInfinity : value; }

// YAML makes an integer of "-1" and a real of "-1.0"; both are numbers.
std::optional<double> number(XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(value);
  if (value.getType() == XmlRpcValue::TypeDouble) return static_cast<double>(value);
  return std::nullopt;
}

RadarConfig radarFromEntry(const std::string& name, XmlRpcValue& entry) {
  const std::string where = "radars/" + name;
  if (entry.getType() != XmlRpcValue::TypeStruct) {
    throw std::invalid_argument(where +
                                ": expected {topic: ..., doppler_scale: ..., mount_yaw_correction: ...}");
  }
  RadarConfig radar;
  radar.name = name;
  for (auto& [key, value] : entry) {
    if (key == "topic") {
      if (value.getType() == XmlRpcValue::TypeString) radar.topic = static_cast<std::string>(value);
    } else if (key == "doppler_scale") {
      radar.doppler_scale = number(value);
      if (!radar.doppler_scale || !std::isfinite(*radar.doppler_scale) || *radar.doppler_scale == 0.0) {
        throw std::invalid_argument(where + "/doppler_scale: expected a number other than 0");
      }
    } else if (key == "mount_yaw_correction") {
      const std::optional<double> yaw = number(value);
      if (!yaw || !std::isfinite(*yaw)) {
        throw std::invalid_argument(where + "/mount_yaw_correction: expected an angle in rad");
      }
      radar.mount_yaw_correction = *yaw;
    } else {
      throw std::invalid_argument(where + "/" + key +
                                  ": unknown; known are topic, doppler_scale, mount_yaw_correction");
    }
  }
  if (radar.topic.empty()) throw std::invalid_argument(where + "/topic: set the name of a PointCloud2 topic");
  return radar;
}

// Parameters that make sense only together.
std::vector<std::vector<std::string>> pairedParameters() {
  return {{"min_range", "max_range"},
          {"min_azimuth", "max_azimuth"},
          {"min_rcs", "max_rcs"},
          {"mask_bottom", "mask_top"}};
}

}  // namespace

std::vector<RadarConfig> radarsFromParameter(XmlRpcValue& radars, std::vector<std::string>& problems) {
  std::vector<RadarConfig> result;
  if (radars.getType() != XmlRpcValue::TypeStruct) {
    problems.emplace_back("radars: expected a dictionary name -> {topic: ...}");
    return result;
  }
  for (auto& [name, entry] : radars) {
    try {
      result.push_back(radarFromEntry(name, entry));
    } catch (const std::invalid_argument& error) {
      problems.emplace_back(error.what());
    }
  }
  return result;
}

std::vector<int> stateList(const std::string& text, const std::string& parameter) {
  std::vector<int> states;
  if (text.find_first_not_of(" \t") == std::string::npos) return states;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    std::size_t used = 0;
    int state = -1;
    try {
      state = std::stoi(item, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || item.find_first_not_of(" \t", used) != std::string::npos || state < 0 || state > 255) {
      throw std::invalid_argument(parameter + ": '" + text +
                                  "' is not a list of states 0..255, as in '0, 4'");
    }
    states.push_back(state);
  }
  return states;
}

std::optional<std::string> stateListText(XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeInt) return std::to_string(static_cast<int>(value));
  if (value.getType() != XmlRpcValue::TypeArray) return std::nullopt;
  std::string text;
  for (int i = 0; i < value.size(); ++i) {
    if (value[i].getType() != XmlRpcValue::TypeInt) return std::nullopt;
    text += (i == 0 ? "" : ", ") + std::to_string(static_cast<int>(value[i]));
  }
  return text;
}

ExtractionParams extractionParams(const EgoVelocityConfig& config) {
  const EgoVelocityConfig& lowest = EgoVelocityConfig::__getMin__();
  const EgoVelocityConfig& highest = EgoVelocityConfig::__getMax__();
  ExtractionParams params;
  params.doppler_field = config.doppler_field;
  params.doppler_scale = config.doppler_scale;
  params.filter.min_range = config.min_range;
  params.filter.max_range = config.max_range;
  params.filter.min_azimuth = lowerLimit(config.min_azimuth, lowest.min_azimuth);
  params.filter.max_azimuth = upperLimit(config.max_azimuth, highest.max_azimuth);
  params.filter.min_rcs = lowerLimit(config.min_rcs, lowest.min_rcs);
  params.filter.max_rcs = upperLimit(config.max_rcs, highest.max_rcs);
  params.filter.invalid_states = stateList(config.invalid_states, "invalid_states");
  params.filter.ambig_states = stateList(config.ambig_states, "ambig_states");
  params.filter.pdh0_states = stateList(config.pdh0_states, "pdh0_states");
  if (!(params.filter.min_azimuth < params.filter.max_azimuth)) {
    throw std::invalid_argument("min_azimuth must be smaller than max_azimuth");
  }
  if (!(params.filter.min_rcs < params.filter.max_rcs)) {
    throw std::invalid_argument("min_rcs must be smaller than max_rcs");
  }
  return params;
}

EgoVelocityParams estimatorParams(const EgoVelocityConfig& config) {
  EgoVelocityParams params;
  params.model = motionModelFromString(config.model);
  params.solver = solverFromString(config.solver);
  params.two_pass = config.two_pass;
  params.seed = static_cast<std::uint64_t>(config.seed);
  params.ransac_iterations = config.ransac_iterations;
  params.inlier_threshold = config.inlier_threshold;
  params.robust_iterations = config.robust_iterations;
  params.doppler_std = config.doppler_std;
  params.azimuth_std = config.azimuth_std;
  params.min_returns = config.min_returns;
  params.min_inlier_share = config.min_inlier_share;
  params.max_condition_number = config.max_condition_number;
  params.scan_std = config.scan_std;
  params.sideslip_std = config.sideslip_std;
  params.unobserved_variance = config.unobserved_variance;
  params.segmentation.threshold = config.threshold;
  params.segmentation.neighbourhood = config.neighbourhood;
  params.segmentation.isolated_threshold = config.isolated_threshold;
  params.segmentation.supported_threshold = config.supported_threshold;
  params.segmentation.neighbour_distance = config.neighbour_distance;
  params.segmentation.neighbour_velocity = config.neighbour_velocity;
  return params;
}

VelocityFilterParams filterParams(const EgoVelocityConfig& config) {
  if (!std::isfinite(config.bearing_delay)) throw std::invalid_argument("bearing_delay must be finite");
  VelocityFilterParams params;
  params.longitudinal_jerk = config.longitudinal_jerk;
  params.lateral_jerk = config.lateral_jerk;
  params.curvature_rate = config.curvature_rate;
  params.yaw_jerk = config.yaw_jerk;
  params.yaw_acceleration_time = config.yaw_acceleration_time;
  params.lateral_slip_std = config.lateral_slip_std;
  params.lateral_slip_time = config.lateral_slip_time;
  params.mount_yaw_std = config.mount_yaw_std;
  params.error_correlation_time = config.error_correlation_time;
  params.max_rejected = config.max_rejected;
  params.max_gap = config.max_filter_gap;
  return params;
}

MaskFootprint maskFootprint(const EgoVelocityConfig& config) {
  if (!(config.mask_bottom < config.mask_top)) {
    throw std::invalid_argument("mask_bottom must be smaller than mask_top");
  }
  return {config.mask_bottom, config.mask_top, config.mask_min_share};
}

MendedConfig mendedConfig(const EgoVelocityConfig& config) {
  const Mended<EgoVelocityConfig> mended = mend<EgoVelocityConfig>(
      config,
      [](const EgoVelocityConfig& candidate) {
        const DopplerExtractor extractor(extractionParams(candidate));
        const EgoVelocityEstimator estimator(estimatorParams(candidate));
        const VelocityFilter filter(filterParams(candidate));
        maskFootprint(candidate);
      },
      pairedParameters());
  MendedConfig result{mended.config, mended.problems, mended.valid, mended.valid};
  for (const std::vector<std::string>& part : mended.replaced) {
    // The default of the scale may have the wrong sign for these radars: better no velocity.
    if (part.front() == "doppler_scale") result.usable = false;
  }
  return result;
}

double positiveParameter(const ros::NodeHandle& private_handle, const std::string& name,
                         double default_value) {
  double value = default_value;
  private_handle.param(name, value, default_value);
  if (std::isfinite(value) && value > 0.0) return value;
  ROS_ERROR("%s must be positive, but is %g; using %g", private_handle.resolveName(name).c_str(), value,
            default_value);
  return default_value;
}

}  // namespace radar_dot
