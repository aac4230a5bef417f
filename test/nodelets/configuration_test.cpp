// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What the nodelets decide by their configurations.
#include <gtest/gtest.h>

#include <string>

#include "nodelets/common/read_parameters.h"
#include "nodelets/common/reconfigure_server.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {
namespace {

TEST(FailsWithItsCalls, RqtAlone) {
  for (const char* node : {"/rqt_reconfigure", "/rqt_gui_py_node_4711", "/robot/rqt_gui_py_node_12", "/rqt"})
    EXPECT_TRUE(failsWithItsCalls(node)) << node;
  for (const char* node : {"/dynparam_set_1", "/tuner", "/rqt_bag/recorder", "/my_rqt", "", "/"})
    EXPECT_FALSE(failsWithItsCalls(node)) << node;
}

/// As readConfig does it, without a parameter server.
ParameterProblems problemsOf(EgoVelocityConfig& config) {
  EgoVelocityConfig defaults;
  ParameterProblems problems;
  EXPECT_TRUE(fallBackUntil([&config] { validateConfig(config); }, "/ego_velocity", fieldsOf(config),
                            fieldsOf(defaults), problems));
  return problems;
}

TEST(Radars, AnInvalidEntryIsLeftOutAlone) {
  EgoVelocityConfig config;
  config.radars["good"].topic = "a";
  config.radars["mute"].doppler_scale = -1.0;
  config.radars["zero"] = {"b", 0.0, 0.0};
  config.radars["turned"] = {"c", {}, 4.0};
  config.rate.expected_rate = 20.0;
  const ParameterProblems problems = problemsOf(config);
  ASSERT_EQ(config.radars.size(), 1U);
  EXPECT_EQ(config.radars.begin()->first, "good");
  EXPECT_EQ(config.rate.expected_rate, 20.0);
  for (const char* text :
       {"radars/mute/topic is empty", "radars/zero/doppler_scale is 0; it must not be zero",
        "radars/turned/mount_yaw_correction is 4, must be between"})
    EXPECT_NE(problems.text().find(text), std::string::npos) << text << ": " << problems.text();
  EXPECT_TRUE(problems.concern("radars/zero"));
}

TEST(ParameterProblems, ThoseOfParametersReadAtStartOutlastAChange) {
  EgoVelocityConfig config;
  config.radars["mute"].doppler_scale = -1.0;
  config.extraction.doppler_scale = 0.0;
  ParameterProblems problems = problemsOf(config);
  EXPECT_EQ(config.extraction.doppler_scale, 1.0);
  EXPECT_TRUE(problems.concern(nameOf(config, config.extraction.doppler_scale)));
  EXPECT_EQ(problems.lines.size(), 2U);
  problems.settle({"threshold"});
  ASSERT_EQ(problems.lines.size(), 1U);
  EXPECT_NE(problems.lines[0].find("radars/mute"), std::string::npos);
  EXPECT_TRUE(problems.concern(nameOf(config, config.extraction.doppler_scale))) << "it was not corrected";
  problems.settle({"doppler_scale"});
  EXPECT_FALSE(problems.concern(nameOf(config, config.extraction.doppler_scale)));
}

}  // namespace
}  // namespace radar_dot
