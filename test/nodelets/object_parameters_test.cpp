// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/object_parameters.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace radar_dot {
namespace {

void expectEqual(const OverGroundParams& params, const OverGroundParams& expected) {
  EXPECT_EQ(params.range_std, expected.range_std);
  EXPECT_EQ(params.azimuth_std, expected.azimuth_std);
  EXPECT_EQ(params.doppler_std, expected.doppler_std);
  EXPECT_EQ(params.segmentation.isolated_threshold, expected.segmentation.isolated_threshold);
  EXPECT_EQ(params.segmentation.supported_threshold, expected.segmentation.supported_threshold);
  EXPECT_EQ(params.segmentation.neighbour_distance, expected.segmentation.neighbour_distance);
  EXPECT_EQ(params.segmentation.neighbour_velocity, expected.segmentation.neighbour_velocity);
}

void expectEqual(const DetectionParams& params, const DetectionParams& expected) {
  EXPECT_EQ(params.max_distance, expected.max_distance);
  EXPECT_EQ(params.max_velocity_difference, expected.max_velocity_difference);
  EXPECT_EQ(params.extent_std, expected.extent_std);
  EXPECT_EQ(params.shared_velocity_std, expected.shared_velocity_std);
  EXPECT_EQ(params.unobserved_std, expected.unobserved_std);
  EXPECT_EQ(params.weak_threshold, expected.weak_threshold);
  EXPECT_EQ(params.region_gate, expected.region_gate);
}

void expectEqual(const ObjectTrackerParams& params, const ObjectTrackerParams& expected) {
  EXPECT_EQ(params.acceleration_std, expected.acceleration_std);
  EXPECT_EQ(params.initial_speed_std, expected.initial_speed_std);
  EXPECT_EQ(params.gate, expected.gate);
  EXPECT_EQ(params.confirm_hits, expected.confirm_hits);
  EXPECT_EQ(params.confirm_scans, expected.confirm_scans);
  EXPECT_EQ(params.min_coast, expected.min_coast);
  EXPECT_EQ(params.max_coast, expected.max_coast);
  EXPECT_EQ(params.max_weak_time, expected.max_weak_time);
  EXPECT_EQ(params.min_body_length, expected.min_body_length);
  EXPECT_EQ(params.max_body_length, expected.max_body_length);
  EXPECT_EQ(params.max_body_width, expected.max_body_width);
  EXPECT_EQ(params.body_time, expected.body_time);
  EXPECT_EQ(params.body_velocity, expected.body_velocity);
  EXPECT_EQ(params.max_lag, expected.max_lag);
  EXPECT_EQ(params.min_speed, expected.min_speed);
}

void expectEqual(const MaskRegionParams& params, const MaskRegionParams& expected) {
  EXPECT_EQ(params.min_pixels, expected.min_pixels);
  EXPECT_EQ(params.pixel_std, expected.pixel_std);
  EXPECT_EQ(params.relative_depth_std, expected.relative_depth_std);
  EXPECT_EQ(params.flow_std, expected.flow_std);
}

TEST(ObjectParameters, DefaultsOfTheConfigAreThoseOfTheLibrary) {
  const MovingObjectsConfig& config = MovingObjectsConfig::__getDefault__();
  expectEqual(overGroundParams(config), OverGroundParams{});
  expectEqual(detectionParams(config), DetectionParams{});
  expectEqual(objectTrackerParams(config), ObjectTrackerParams{});
  expectEqual(maskRegionParams(config), MaskRegionParams{});
  EXPECT_NO_THROW(validate(config));
}

// Values that differ from each other and from every default, so that one left out or taken twice shows.
TEST(ObjectParameters, EveryParameterArrives) {
  MovingObjectsConfig config = MovingObjectsConfig::__getDefault__();
  OverGroundParams returns;
  config.range_std = returns.range_std = 0.31;
  config.azimuth_std = returns.azimuth_std = 0.032;
  config.doppler_std = returns.doppler_std = 0.33;
  config.isolated_threshold = returns.segmentation.isolated_threshold = 1.4;
  config.supported_threshold = returns.segmentation.supported_threshold = 0.7;
  config.neighbour_distance = returns.segmentation.neighbour_distance = 2.6;
  config.neighbour_velocity = returns.segmentation.neighbour_velocity = 1.7;
  expectEqual(overGroundParams(config), returns);

  DetectionParams detection;
  config.max_distance = detection.max_distance = 3.1;
  config.max_velocity_difference = detection.max_velocity_difference = 1.2;
  config.extent_std = detection.extent_std = 0.6;
  config.shared_velocity_std = detection.shared_velocity_std = 0.14;
  config.weak_threshold = detection.weak_threshold = 0.45;
  expectEqual(detectionParams(config), detection);

  ObjectTrackerParams tracker;
  config.acceleration_std = tracker.acceleration_std = 2.1;
  config.initial_speed_std = tracker.initial_speed_std = 4.2;
  config.gate = tracker.gate = 3.3;
  config.confirm_hits = tracker.confirm_hits = 4;
  config.confirm_scans = tracker.confirm_scans = 6;
  config.min_coast = tracker.min_coast = 0.26;
  config.max_coast = tracker.max_coast = 0.87;
  config.max_weak_time = tracker.max_weak_time = 1.08;
  config.min_body_length = tracker.min_body_length = 2.09;
  config.max_body_length = tracker.max_body_length = 7.1;
  config.max_body_width = tracker.max_body_width = 2.7;
  config.body_time = tracker.body_time = 2.2;
  config.body_velocity = tracker.body_velocity = 2.3;
  config.max_lag = tracker.max_lag = 0.24;
  config.min_speed = tracker.min_speed = 0.55;
  expectEqual(objectTrackerParams(config), tracker);

  MaskRegionParams mask;
  mask.min_pixels = 61;
  config.min_pixels = 61;
  config.pixel_std = mask.pixel_std = 3.5;
  config.relative_depth_std = mask.relative_depth_std = 0.16;
  config.flow_std = mask.flow_std = 1.5;
  expectEqual(maskRegionParams(config), mask);
}

TEST(ObjectParameters, NonsenseIsRefused) {
  MovingObjectsConfig config = MovingObjectsConfig::__getDefault__();
  config.min_coast = 2.0;
  EXPECT_THROW(validate(config), std::invalid_argument);
  config = MovingObjectsConfig::__getDefault__();
  config.min_body_length = 8.0;
  EXPECT_THROW(validate(config), std::invalid_argument);
  config = MovingObjectsConfig::__getDefault__();
  config.flow_std = -1.0;
  EXPECT_THROW(validate(config), std::invalid_argument);
  config = MovingObjectsConfig::__getDefault__();
  config.gate = 0.0;
  EXPECT_THROW(validate(config), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot
