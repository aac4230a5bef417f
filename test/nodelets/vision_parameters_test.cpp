// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/vision_parameters.h"

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

namespace radar_dot {
namespace {

// What dynamic_reconfigure offers for a parameter with a list of values.
std::vector<std::string> offered(const std::string& name) {
  std::vector<std::string> values;
  for (const auto& field : OpticalFlowConfig::__getParamDescriptions__()) {
    if (field->name != name) continue;
    const std::regex value("'value': '([^']*)'");
    for (std::sregex_iterator match(field->edit_method.begin(), field->edit_method.end(), value), end;
         match != end; ++match) {
      values.push_back((*match)[1]);
    }
  }
  return values;
}

void expectEqual(const NetworkParams& params, const NetworkParams& expected) {
  EXPECT_EQ(params.model, expected.model);
  EXPECT_EQ(params.device, expected.device);
  EXPECT_EQ(params.threads, expected.threads);
}

void expectEqual(const OpticalFlowParams& params, const OpticalFlowParams& expected) {
  EXPECT_EQ(params.backend, expected.backend);
  EXPECT_EQ(params.working_width, expected.working_width);
  EXPECT_EQ(params.preset, expected.preset);
  EXPECT_EQ(params.initialisation, expected.initialisation);
  EXPECT_EQ(params.forward_backward, expected.forward_backward);
  EXPECT_EQ(params.forward_backward_absolute, expected.forward_backward_absolute);
  EXPECT_EQ(params.forward_backward_relative, expected.forward_backward_relative);
  expectEqual(params.network, expected.network);
  EXPECT_EQ(params.network_width, expected.network_width);
  EXPECT_EQ(params.network_height, expected.network_height);
}

void expectEqual(const DepthParams& params, const DepthParams& expected) {
  EXPECT_EQ(params.backend, expected.backend);
  EXPECT_EQ(params.max_depth, expected.max_depth);
  EXPECT_EQ(params.ground_pitch, expected.ground_pitch);
  EXPECT_EQ(params.ground_height, expected.ground_height);
  EXPECT_EQ(params.column_height, expected.column_height);
  EXPECT_EQ(params.column_half_width, expected.column_half_width);
  EXPECT_EQ(params.azimuth_std, expected.azimuth_std);
  EXPECT_EQ(params.image_edges, expected.image_edges);
  EXPECT_EQ(params.background_depth, expected.background_depth);
  EXPECT_EQ(params.background_angle, expected.background_angle);
  EXPECT_EQ(params.relative_std, expected.relative_std);
  EXPECT_EQ(params.ground_pitch_std, expected.ground_pitch_std);
  EXPECT_EQ(params.ground_height_std, expected.ground_height_std);
  EXPECT_EQ(params.ground_relative_std, expected.ground_relative_std);
  EXPECT_EQ(params.column_std, expected.column_std);
  EXPECT_EQ(params.background_std, expected.background_std);
  EXPECT_EQ(params.lidar_std, expected.lidar_std);
  EXPECT_EQ(params.completion_std, expected.completion_std);
  EXPECT_EQ(params.completion_kernel, expected.completion_kernel);
  expectEqual(params.network, expected.network);
}

void expectEqual(const MotionParams& params, const MotionParams& expected) {
  EXPECT_EQ(params.k, expected.k);
  EXPECT_EQ(params.lambda, expected.lambda);
  EXPECT_EQ(params.min_depth, expected.min_depth);
  EXPECT_EQ(params.foe_std, expected.foe_std);
  EXPECT_EQ(params.occlusion_margin, expected.occlusion_margin);
  EXPECT_EQ(params.max_depth, expected.max_depth);
  EXPECT_EQ(params.opening, expected.opening);
  EXPECT_EQ(params.closing, expected.closing);
  EXPECT_EQ(params.min_threshold, expected.min_threshold);
  EXPECT_EQ(params.predicted_in_view, expected.predicted_in_view);
  EXPECT_EQ(params.score, expected.score);
  EXPECT_EQ(params.flow_std, expected.flow_std);
  EXPECT_EQ(params.flow_std_relative, expected.flow_std_relative);
  EXPECT_EQ(params.fb_error_weight, expected.fb_error_weight);
  EXPECT_EQ(params.depth_std, expected.depth_std);
  EXPECT_EQ(params.next_depth_std, expected.next_depth_std);
  EXPECT_EQ(params.false_alarm, expected.false_alarm);
  EXPECT_EQ(params.min_scale, expected.min_scale);
  EXPECT_EQ(params.seed, expected.seed);
  EXPECT_EQ(params.radar_azimuth_std, expected.radar_azimuth_std);
  EXPECT_EQ(params.radar_gain, expected.radar_gain);
  EXPECT_EQ(params.radar_radius, expected.radar_radius);
}

void expectEqual(const MotionUncertainty& uncertainty, const MotionUncertainty& expected) {
  EXPECT_EQ(uncertainty.forward_velocity_std, expected.forward_velocity_std);
  EXPECT_EQ(uncertainty.lateral_velocity_std, expected.lateral_velocity_std);
  EXPECT_EQ(uncertainty.vertical_velocity_std, expected.vertical_velocity_std);
  EXPECT_EQ(uncertainty.yaw_rate_std, expected.yaw_rate_std);
  EXPECT_EQ(uncertainty.tilt_std, expected.tilt_std);
}

// dynamic_reconfigure is where a user reads the defaults: they must be those of the library.
TEST(VisionParameters, DefaultsOfTheConfigsAreThoseOfTheLibrary) {
  expectEqual(opticalFlowParams(OpticalFlowConfig::__getDefault__()), OpticalFlowParams{});
  expectEqual(depthParams(DepthConfig::__getDefault__()), DepthParams{});
  expectEqual(motionParams(DynamicSegmentationConfig::__getDefault__()), MotionParams{});
  expectEqual(motionUncertainty(DynamicSegmentationConfig::__getDefault__()), MotionUncertainty{});
}

TEST(VisionParameters, DefaultsAreAccepted) {
  EXPECT_NE(makeOpticalFlow(opticalFlowParams(OpticalFlowConfig::__getDefault__())), nullptr);
  EXPECT_NE(makeDepthEstimator(depthParams(DepthConfig::__getDefault__())), nullptr);
  EXPECT_NO_THROW(validate(motionParams(DynamicSegmentationConfig::__getDefault__())));
}

// Values that differ from each other and from every default, so that one left out or taken twice shows.
TEST(VisionParameters, EveryParameterOfOpticalFlowArrives) {
  OpticalFlowConfig config = OpticalFlowConfig::__getDefault__();
  OpticalFlowParams expected;
  config.backend = expected.backend = "other";
  config.working_width = expected.working_width = 320;
  config.preset = expected.preset = "fine";
  config.initialisation = expected.initialisation = "expected";
  config.forward_backward = expected.forward_backward = true;
  config.forward_backward_absolute = expected.forward_backward_absolute = 0.75;
  config.forward_backward_relative = expected.forward_backward_relative = 0.125;
  config.model = expected.network.model = "flow.pt";
  config.device = expected.network.device = "cpu";
  config.threads = expected.network.threads = 3;
  config.network_width = expected.network_width = 512;
  config.network_height = expected.network_height = 288;
  expectEqual(opticalFlowParams(config), expected);
}

TEST(VisionParameters, EveryParameterOfDepthArrives) {
  DepthConfig config = DepthConfig::__getDefault__();
  DepthParams expected;
  config.backend = expected.backend = "lidar";
  config.max_depth = expected.max_depth = 81.0;
  config.ground_pitch = expected.ground_pitch = 0.01;
  config.ground_height = expected.ground_height = -0.3;
  config.column_height = expected.column_height = 1.9;
  config.column_half_width = expected.column_half_width = 0.7;
  config.azimuth_std = expected.azimuth_std = 0.03;
  config.image_edges = expected.image_edges = true;
  config.background_depth = expected.background_depth = 55.0;
  config.background_angle = expected.background_angle = 0.2;
  config.relative_std = expected.relative_std = 0.11;
  config.ground_pitch_std = expected.ground_pitch_std = 0.03;
  config.ground_height_std = expected.ground_height_std = 0.06;
  config.ground_relative_std = expected.ground_relative_std = 0.14;
  config.column_std = expected.column_std = 0.45;
  config.background_std = expected.background_std = 0.75;
  config.lidar_std = expected.lidar_std = 0.045;
  config.completion_std = expected.completion_std = 0.0125;
  config.completion_kernel = expected.completion_kernel = 33;
  config.model = expected.network.model = "depth.pt";
  config.device = expected.network.device = "cuda:1";
  config.threads = expected.network.threads = 4;
  expectEqual(depthParams(config), expected);
}

TEST(VisionParameters, EveryParameterOfTheSegmentationArrives) {
  DynamicSegmentationConfig config = DynamicSegmentationConfig::__getDefault__();
  MotionParams expected;
  config.k = expected.k = 6.0;
  config.lambda = expected.lambda = 0.25;
  config.min_depth = expected.min_depth = 1.5;
  config.foe_std = expected.foe_std = 80.0;
  config.occlusion_margin = expected.occlusion_margin = 0.4;
  config.max_depth = expected.max_depth = 70.0;
  config.opening = expected.opening = 3;
  config.closing = expected.closing = 11;
  config.min_threshold = expected.min_threshold = 2.5;
  config.predicted_in_view = expected.predicted_in_view = false;
  config.score = "uncertainty";
  expected.score = MotionScore::kUncertainty;
  config.flow_std = expected.flow_std = 1.25;
  config.flow_std_relative = expected.flow_std_relative = 0.0625;
  config.fb_error_weight = expected.fb_error_weight = 0.375;
  config.depth_std = expected.depth_std = 0.15;
  config.next_depth_std = expected.next_depth_std = 0.35;
  config.false_alarm = expected.false_alarm = 1e-4;
  config.min_scale = expected.min_scale = 0.75;
  config.seed = expected.seed = 1.75;
  config.radar_azimuth_std = expected.radar_azimuth_std = 0.02;
  config.radar_gain = expected.radar_gain = 0.75;
  config.radar_radius = expected.radar_radius = 1.25;
  expectEqual(motionParams(config), expected);
  config.score = "guess";
  EXPECT_THROW(motionParams(config), std::invalid_argument);

  MotionUncertainty uncertainty;
  config.forward_velocity_std = uncertainty.forward_velocity_std = 0.21;
  config.lateral_velocity_std = uncertainty.lateral_velocity_std = 0.22;
  config.vertical_velocity_std = uncertainty.vertical_velocity_std = 0.23;
  config.yaw_rate_std = uncertainty.yaw_rate_std = 0.024;
  config.tilt_std = uncertainty.tilt_std = 0.025;
  expectEqual(motionUncertainty(config), uncertainty);
}

TEST(VisionParameters, EveryPresetAndInitialisationOnOfferIsKnown) {
  const std::vector<std::string> presets = offered("preset"), initialisations = offered("initialisation");
  EXPECT_EQ(presets, (std::vector<std::string>{OpticalFlow_ultrafast, OpticalFlow_fast, OpticalFlow_medium,
                                               OpticalFlow_fine}));
  EXPECT_EQ(initialisations,
            (std::vector<std::string>{OpticalFlow_none, OpticalFlow_temporal, OpticalFlow_expected}));
  OpticalFlowConfig config = OpticalFlowConfig::__getDefault__();
  for (const std::string& preset : presets) {
    for (const std::string& initialisation : initialisations) {
      config.preset = preset;
      config.initialisation = initialisation;
      EXPECT_NO_THROW(makeOpticalFlow(opticalFlowParams(config))) << preset << ", " << initialisation;
    }
  }
  config.preset = "turbo";
  EXPECT_THROW(makeOpticalFlow(opticalFlowParams(config)), std::invalid_argument);
}

TEST(VisionParameters, ATwistMayBeLessCertainThanTheParameters) {
  DynamicSegmentationConfig config = DynamicSegmentationConfig::__getDefault__();
  config.forward_velocity_std = 0.1;
  config.lateral_velocity_std = 0.06;
  config.yaw_rate_std = 0.006;
  geometry_msgs::TwistWithCovariance::_covariance_type covariance{};
  covariance[0] = 0.25 * 0.25;
  covariance[7] = 1e6;  // not observed
  covariance[35] = 0.02 * 0.02;
  const MotionUncertainty wide = motionUncertainty(config, covariance, /*has_rotation=*/false);
  EXPECT_NEAR(wide.forward_velocity_std, 0.25, 1e-12);
  EXPECT_EQ(wide.lateral_velocity_std, 0.06);
  EXPECT_NEAR(wide.yaw_rate_std, 0.02, 1e-12);
  EXPECT_EQ(motionUncertainty(config, covariance, /*has_rotation=*/true).yaw_rate_std, 0.006);
  covariance[0] = 0.05 * 0.05;
  EXPECT_EQ(motionUncertainty(config, covariance, false).forward_velocity_std, 0.1);
}

}  // namespace
}  // namespace radar_dot
