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
  config.radars["mute"].mount_yaw_correction = 0.1;
  config.radars["zero"].topic = "b";
  config.radars["zero"].overrides["doppler_scale"] = 0.0;
  config.radars["turned"].topic = "c";
  config.radars["turned"].mount_yaw_correction = 4.0;
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

TEST(Radars, AnEntryOfTheParameterServerHoldsWhatIsOfThisRadarAlone) {
  XmlRpc::XmlRpcValue given;
  XmlRpc::XmlRpcValue& front = given["radars"]["front"];
  front["topic"] = "a";
  front["doppler_field"] = "v";
  front["max_range"] = 90;
  front["invalid_states"].setSize(0);
  front["stamp"] = "arrival";
  front["mount_xyz"][0] = 3.5;
  front["mount_xyz"][1] = 0;
  front["mount_xyz"][2] = "5e-1";
  given["radars"]["short"]["mount_xyz"][0] = 1.0;
  given["radars"]["misspelt"]["doppler_fild"] = "v";
  EgoVelocityConfig config;
  ParameterProblems problems;
  readFields(given, "/ego_velocity", fieldsOf(config), problems);
  ASSERT_EQ(config.radars.size(), 1U);
  const RadarEntry& entry = config.radars.at("front");
  EXPECT_EQ(entry.mount_xyz, (std::array<double, 3>{3.5, 0.0, 0.5}));
  EXPECT_EQ(entry.stamp, StampSource::kArrival);
  const ExtractionParams params = extractionOf(config, entry);
  EXPECT_EQ(params.doppler_field, "v");
  EXPECT_EQ(params.filter.max_range, 90.0);
  EXPECT_TRUE(params.filter.invalid_states.empty());
  EXPECT_EQ(
      problems.lines,
      (std::vector<std::string>{
          "/ego_velocity/radars/misspelt/doppler_fild is unknown; did you mean 'doppler_field'?; misspelt is "
          "left out",
          "/ego_velocity/radars/short/mount_xyz is 1, must be 3 numbers between -1000 and 1000 m; short is "
          "left "
          "out"}));
}

TEST(ParameterProblems, ThoseOfParametersReadAtStartOutlastAChange) {
  EgoVelocityConfig config;
  config.radars["mute"];
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
