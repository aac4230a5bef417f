// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/parameters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace radar_dot {
namespace {

using XmlRpc::XmlRpcValue;

// dynamic_reconfigure is where a user reads the defaults: they must be those of the library.
TEST(Parameters, DefaultsOfTheConfigAreThoseOfTheExtraction) {
  const ExtractionParams configured = extractionParams(EgoVelocityConfig::__getDefault__());
  const ExtractionParams expected;
  EXPECT_EQ(configured.doppler_field, expected.doppler_field);
  EXPECT_EQ(configured.doppler_scale, expected.doppler_scale);
  EXPECT_EQ(configured.filter.min_range, expected.filter.min_range);
  EXPECT_EQ(configured.filter.max_range, expected.filter.max_range);
  EXPECT_EQ(configured.filter.min_azimuth, expected.filter.min_azimuth);
  EXPECT_EQ(configured.filter.max_azimuth, expected.filter.max_azimuth);
  EXPECT_EQ(configured.filter.min_rcs, expected.filter.min_rcs);
  EXPECT_EQ(configured.filter.max_rcs, expected.filter.max_rcs);
  EXPECT_EQ(configured.filter.invalid_states, expected.filter.invalid_states);
  EXPECT_EQ(configured.filter.ambig_states, expected.filter.ambig_states);
  EXPECT_EQ(configured.filter.pdh0_states, expected.filter.pdh0_states);
}

TEST(Parameters, DefaultsOfTheConfigAreThoseOfTheEstimator) {
  const EgoVelocityParams configured = estimatorParams(EgoVelocityConfig::__getDefault__());
  const EgoVelocityParams expected;
  EXPECT_EQ(configured.model, expected.model);
  EXPECT_EQ(configured.solver, expected.solver);
  EXPECT_EQ(configured.two_pass, expected.two_pass);
  EXPECT_EQ(configured.seed, expected.seed);
  EXPECT_EQ(configured.ransac_iterations, expected.ransac_iterations);
  EXPECT_EQ(configured.inlier_threshold, expected.inlier_threshold);
  EXPECT_EQ(configured.robust_iterations, expected.robust_iterations);
  EXPECT_EQ(configured.doppler_std, expected.doppler_std);
  EXPECT_EQ(configured.azimuth_std, expected.azimuth_std);
  EXPECT_EQ(configured.min_returns, expected.min_returns);
  EXPECT_EQ(configured.min_inlier_share, expected.min_inlier_share);
  EXPECT_EQ(configured.max_condition_number, expected.max_condition_number);
  EXPECT_EQ(configured.scan_std, expected.scan_std);
  EXPECT_EQ(configured.sideslip_std, expected.sideslip_std);
  EXPECT_EQ(configured.unobserved_variance, expected.unobserved_variance);
  EXPECT_EQ(configured.segmentation.threshold, expected.segmentation.threshold);
  EXPECT_EQ(configured.segmentation.neighbourhood, expected.segmentation.neighbourhood);
  EXPECT_EQ(configured.segmentation.isolated_threshold, expected.segmentation.isolated_threshold);
  EXPECT_EQ(configured.segmentation.supported_threshold, expected.segmentation.supported_threshold);
  EXPECT_EQ(configured.segmentation.neighbour_distance, expected.segmentation.neighbour_distance);
  EXPECT_EQ(configured.segmentation.neighbour_velocity, expected.segmentation.neighbour_velocity);
}

TEST(Parameters, DefaultsOfTheConfigAreThoseOfTheFilter) {
  const VelocityFilterParams configured = filterParams(EgoVelocityConfig::__getDefault__());
  const VelocityFilterParams expected;
  EXPECT_EQ(configured.longitudinal_jerk, expected.longitudinal_jerk);
  EXPECT_EQ(configured.lateral_jerk, expected.lateral_jerk);
  EXPECT_EQ(configured.curvature_rate, expected.curvature_rate);
  EXPECT_EQ(configured.yaw_jerk, expected.yaw_jerk);
  EXPECT_EQ(configured.yaw_acceleration_time, expected.yaw_acceleration_time);
  EXPECT_EQ(configured.lateral_slip_std, expected.lateral_slip_std);
  EXPECT_EQ(configured.lateral_slip_time, expected.lateral_slip_time);
  EXPECT_EQ(configured.mount_yaw_std, expected.mount_yaw_std);
  EXPECT_EQ(configured.error_correlation_time, expected.error_correlation_time);
  EXPECT_EQ(configured.max_rejected, expected.max_rejected);
  EXPECT_EQ(configured.max_gap, expected.max_gap);
}

TEST(Parameters, EveryModelAndSolverOfTheConfigIsKnown) {
  EgoVelocityConfig config = EgoVelocityConfig::__getDefault__();
  for (const char* model :
       {EgoVelocity_planar, EgoVelocity_planar_yaw, EgoVelocity_ackermann, EgoVelocity_spatial}) {
    config.model = model;
    EXPECT_EQ(toString(estimatorParams(config).model), model);
  }
  for (const char* solver : {EgoVelocity_least_squares, EgoVelocity_ransac, EgoVelocity_ransac_robust}) {
    config.solver = solver;
    EXPECT_EQ(toString(estimatorParams(config).solver), solver);
  }
}

TEST(Parameters, NonsenseIsRefused) {
  const EgoVelocityConfig good = EgoVelocityConfig::__getDefault__();
  EgoVelocityConfig config = good;
  config.model = "helicopter";
  EXPECT_THROW(estimatorParams(config), std::invalid_argument);
  config = good;
  config.min_azimuth = 1.0;
  config.max_azimuth = -1.0;
  EXPECT_THROW(extractionParams(config), std::invalid_argument);
  config = good;
  config.min_rcs = 5.0;
  config.max_rcs = 5.0;
  EXPECT_THROW(extractionParams(config), std::invalid_argument);
}

TEST(MendedConfig, KeepsWhatIsGoodAndNamesWhatIsNot) {
  EgoVelocityConfig config = EgoVelocityConfig::__getDefault__();
  config.doppler_scale = -1.0;
  config.model = "planar_yew";
  config.solver = "magic";
  config.pdh0_states = "many";
  config.ambig_states = "1, 2";
  config.min_range = 300.0;  // both are fine with the other's default, but not together
  config.max_range = 40.0;
  config.min_azimuth = -0.5;
  config.max_azimuth = 0.5;
  config.threshold = std::numeric_limits<double>::quiet_NaN();
  const MendedConfig mended = mendedConfig(config);
  const EgoVelocityConfig& defaults = EgoVelocityConfig::__getDefault__();
  EXPECT_TRUE(mended.valid);
  EXPECT_TRUE(mended.usable);
  EXPECT_EQ(mended.config.doppler_scale, -1.0);
  EXPECT_EQ(mended.config.ambig_states, "1, 2");
  EXPECT_EQ(mended.config.min_azimuth, -0.5);
  EXPECT_EQ(mended.config.max_azimuth, 0.5);
  EXPECT_EQ(mended.config.model, defaults.model);
  EXPECT_EQ(mended.config.solver, defaults.solver);
  EXPECT_EQ(mended.config.pdh0_states, defaults.pdh0_states);
  EXPECT_EQ(mended.config.min_range, defaults.min_range);
  EXPECT_EQ(mended.config.max_range, defaults.max_range);
  EXPECT_EQ(mended.config.threshold, defaults.threshold);
  ASSERT_EQ(mended.problems.size(), 5U);
  for (const char* name : {"model:", "solver:", "pdh0_states:", "min_range, max_range:", "threshold:"}) {
    EXPECT_TRUE(std::any_of(mended.problems.begin(), mended.problems.end(), [name](const std::string& line) {
      return line.compare(0, std::string(name).size(), name) == 0;
    })) << name;
  }
}

TEST(MendedConfig, GoodOnesAreUntouchedAndAScaleIsNeverGuessed) {
  EgoVelocityConfig config = EgoVelocityConfig::__getDefault__();
  config.seed = 7;
  EXPECT_TRUE(mendedConfig(config).problems.empty());
  EXPECT_EQ(mendedConfig(config).config.seed, 7);
  for (const double scale : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    config.doppler_scale = scale;
    EXPECT_FALSE(mendedConfig(config).usable) << "1 may be the wrong sign";
    EXPECT_EQ(mendedConfig(config).problems.size(), 1U);
    EXPECT_EQ(mendedConfig(config).config.seed, 7);
  }
}

TEST(Parameters, LimitsInsideTheirRangesAreKept) {
  EgoVelocityConfig config = EgoVelocityConfig::__getDefault__();
  config.min_azimuth = -0.5;
  config.max_azimuth = 0.75;
  config.min_rcs = -10.0;
  const ExtractionParams params = extractionParams(config);
  EXPECT_EQ(params.filter.min_azimuth, -0.5);
  EXPECT_EQ(params.filter.max_azimuth, 0.75);
  EXPECT_EQ(params.filter.min_rcs, -10.0);
  EXPECT_TRUE(std::isinf(params.filter.max_rcs));
}

TEST(StateList, ReadsListsAndRefusesAnythingElse) {
  EXPECT_EQ(stateList("", "p"), std::vector<int>{});
  EXPECT_EQ(stateList("  ", "p"), std::vector<int>{});
  EXPECT_EQ(stateList("0", "p"), std::vector<int>{0});
  EXPECT_EQ(stateList(" 0, 4 ,17", "p"), (std::vector<int>{0, 4, 17}));
  for (const char* text : {"a", "1,,2", "1 2", "-1", "256", "1.5", ",1"}) {
    EXPECT_THROW(stateList(text, "p"), std::invalid_argument) << text;
  }
}

TEST(StateList, NumbersAndListsOfYamlBecomeText) {
  XmlRpcValue number(3);
  EXPECT_EQ(stateListText(number), std::string("3"));
  XmlRpcValue list;
  list.setSize(2);
  list[0] = 0;
  list[1] = 4;
  EXPECT_EQ(stateListText(list), std::string("0, 4"));
  XmlRpcValue text("0, 4");
  EXPECT_FALSE(stateListText(text));
}

TEST(Radars, AreReadWithTheirOptions) {
  XmlRpcValue value;
  value["front"]["topic"] = std::string("radar_front");
  value["rear"]["topic"] = std::string("/radar_rear");
  value["rear"]["doppler_scale"] = -1;
  value["rear"]["mount_yaw_correction"] = 0.02;
  std::vector<std::string> problems;
  const std::vector<RadarConfig> radars = radarsFromParameter(value, problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_EQ(radars.size(), 2U);
  EXPECT_EQ(radars[0].name, "front");
  EXPECT_EQ(radars[0].topic, "radar_front");
  EXPECT_FALSE(radars[0].doppler_scale);
  EXPECT_EQ(radars[0].mount_yaw_correction, 0.0);
  EXPECT_EQ(radars[1].doppler_scale, -1.0);
  EXPECT_EQ(radars[1].mount_yaw_correction, 0.02);
}

TEST(Radars, BadEntriesAreNamedAndTheOthersStay) {
  XmlRpcValue value;
  value["good"]["topic"] = std::string("a");
  value["no_topic"]["doppler_scale"] = 1.0;
  value["typo"]["topic"] = std::string("b");
  value["typo"]["dopler_scale"] = 1.0;
  value["zero"]["topic"] = std::string("c");
  value["zero"]["doppler_scale"] = 0;
  value["text"] = std::string("radar");
  std::vector<std::string> problems;
  const std::vector<RadarConfig> radars = radarsFromParameter(value, problems);
  ASSERT_EQ(radars.size(), 1U);
  EXPECT_EQ(radars[0].name, "good");
  ASSERT_EQ(problems.size(), 4U);
  EXPECT_NE(problems[0].find("radars/no_topic/topic"), std::string::npos);
  EXPECT_NE(problems[1].find("radars/text"), std::string::npos);
  EXPECT_NE(problems[2].find("radars/typo/dopler_scale"), std::string::npos);
  EXPECT_NE(problems[3].find("radars/zero/doppler_scale"), std::string::npos);

  XmlRpcValue list;
  list.setSize(1);
  list[0] = std::string("front");
  EXPECT_TRUE(radarsFromParameter(list, problems).empty());
  EXPECT_EQ(problems.size(), 5U);
}

}  // namespace
}  // namespace radar_dot
