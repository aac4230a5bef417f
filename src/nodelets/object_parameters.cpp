// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "object_parameters.h"

#include <stdexcept>

namespace radar_dot {

OverGroundParams overGroundParams(const MovingObjectsConfig& config) {
  OverGroundParams params;
  params.range_std = config.range_std;
  params.azimuth_std = config.azimuth_std;
  params.doppler_std = config.doppler_std;
  params.segmentation.isolated_threshold = config.isolated_threshold;
  params.segmentation.supported_threshold = config.supported_threshold;
  params.segmentation.neighbour_distance = config.neighbour_distance;
  params.segmentation.neighbour_velocity = config.neighbour_velocity;
  return params;
}

DetectionParams detectionParams(const MovingObjectsConfig& config) {
  DetectionParams params;
  params.max_distance = config.max_distance;
  params.max_velocity_difference = config.max_velocity_difference;
  params.extent_std = config.extent_std;
  params.shared_velocity_std = config.shared_velocity_std;
  params.weak_threshold = config.weak_threshold;
  return params;
}

ObjectTrackerParams objectTrackerParams(const MovingObjectsConfig& config) {
  ObjectTrackerParams params;
  params.acceleration_std = config.acceleration_std;
  params.initial_speed_std = config.initial_speed_std;
  params.gate = config.gate;
  params.confirm_hits = config.confirm_hits;
  params.confirm_scans = config.confirm_scans;
  params.min_coast = config.min_coast;
  params.max_coast = config.max_coast;
  params.max_weak_time = config.max_weak_time;
  params.min_body_length = config.min_body_length;
  params.max_body_length = config.max_body_length;
  params.max_body_width = config.max_body_width;
  params.body_time = config.body_time;
  params.body_velocity = config.body_velocity;
  params.max_lag = config.max_lag;
  params.min_speed = config.min_speed;
  return params;
}

MaskRegionParams maskRegionParams(const MovingObjectsConfig& config) {
  MaskRegionParams params;
  params.min_pixels = static_cast<std::size_t>(config.min_pixels);
  params.pixel_std = config.pixel_std;
  params.relative_depth_std = config.relative_depth_std;
  params.flow_std = config.flow_std;
  return params;
}

void validate(const MovingObjectsConfig& config) {
  validate(detectionParams(config));
  validate(objectTrackerParams(config));
  validate(maskRegionParams(config));
  if (config.min_coast > config.max_coast)
    throw std::invalid_argument("min_coast must not be longer than max_coast");
  if (config.min_body_length > config.max_body_length)
    throw std::invalid_argument("min_body_length must not be longer than max_body_length");
}

}  // namespace radar_dot
