// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/read_parameters.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "nodelets/toy_config.h"

namespace radar_dot {
namespace {

using XmlRpc::XmlRpcValue;

template <typename... Items>
XmlRpcValue listOf(const Items&... items) {
  XmlRpcValue list;
  list.setSize(0);
  int i = 0;
  ((list[i++] = XmlRpcValue(items)), ...);
  return list;
}

struct Reading {
  ToyConfig config;
  ParameterProblems problems;
};

Reading read(const XmlRpcValue& given) {
  Reading reading;
  readFields(given, "/toy", fieldsOf(reading.config), reading.problems);
  return reading;
}

TEST(ReadParameters, EveryType) {
  XmlRpcValue given;
  given["frame"] = "axle";
  given["lit"] = false;
  given["lanes"] = 4.0;
  given["near"] = 3;
  given["view"] = 0.5;
  given["tilt"] = -0.5;
  given["mode"] = "fast";
  given["label"] = "a, b";
  given["states"] = listOf(0, 4);
  given["kinds"] = listOf("car", "bus");
  const Reading reading = read(given);
  EXPECT_EQ(reading.problems.text(), "");
  EXPECT_EQ(reading.config.frame, "axle");
  EXPECT_FALSE(reading.config.lit);
  EXPECT_EQ(reading.config.lanes, 4);
  EXPECT_EQ(reading.config.houses, 7U);
  EXPECT_EQ(reading.config.near, 3.0);
  EXPECT_EQ(reading.config.view, 0.5);
  EXPECT_EQ(reading.config.tilt, -0.5);
  EXPECT_EQ(reading.config.mode, Mode::kFast);
  EXPECT_EQ(reading.config.label, "a, b");
  EXPECT_EQ(reading.config.states, (std::vector<int>{0, 4}));
  EXPECT_EQ(reading.config.kinds, (std::vector<std::string>{"car", "bus"}));
}

TEST(ReadParameters, OtherWaysToWriteAValue) {
  XmlRpcValue given;
  given["states"] = "0, 4";
  given["kinds"] = "car, bus";
  given["near"] = "1e-3";
  given["view"] = ".inf";
  Reading reading = read(given);
  EXPECT_EQ(reading.problems.text(), "");
  EXPECT_EQ(reading.config.states, (std::vector<int>{0, 4}));
  EXPECT_EQ(reading.config.kinds, (std::vector<std::string>{"car", "bus"}));
  EXPECT_EQ(reading.config.near, 1e-3);
  EXPECT_EQ(reading.config.view, std::numeric_limits<double>::infinity());
  given["states"] = 3;
  given["kinds"] = listOf();
  given["lit"] = "no";
  given["lanes"] = "4.0";
  given["lamps"]["dark"]["scale"] = "1.0";
  reading = read(given);
  EXPECT_EQ(reading.problems.text(), "");
  EXPECT_FALSE(reading.config.lit);
  EXPECT_EQ(reading.config.lanes, 4);
  EXPECT_EQ(reading.config.states, (std::vector<int>{3}));
  EXPECT_TRUE(reading.config.kinds.empty());
}

TEST(ReadParameters, BadValueHasItsDefaultAndTheOthersStay) {
  XmlRpcValue given;
  given["lanes"] = 50;
  given["houses"] = 9;
  const Reading reading = read(given);
  EXPECT_EQ(reading.config.lanes, 2);
  EXPECT_EQ(reading.config.houses, 9U);
  EXPECT_EQ(reading.problems.text(), "/toy/lanes is 50, must be between 1 and 8; using the default 2");
  EXPECT_TRUE(reading.problems.concern("lanes"));
  EXPECT_FALSE(reading.problems.concern("houses"));
}

TEST(ReadParameters, ProblemsNameTheTypeThatIsWanted) {
  const auto problem = [](const char* name, const XmlRpcValue& value) {
    XmlRpcValue given;
    given[name] = value;
    const Reading reading = read(given);
    EXPECT_TRUE(sameFields(reading.config, ToyConfig())) << name;
    return reading.problems.text();
  };
  XmlRpcValue dictionary;
  dictionary["a"] = 1;
  EXPECT_EQ(problem("lit", 2), "/toy/lit is '2', must be true or false; using the default true");
  EXPECT_EQ(problem("lit", "so"), "/toy/lit is 'so', must be true or false; using the default true");
  EXPECT_EQ(problem("lanes", 2.5), "/toy/lanes is '2.5', must be a whole number; using the default 2");
  EXPECT_EQ(problem("near", "far"), "/toy/near is 'far', must be a number; using the default 1 m");
  EXPECT_EQ(problem("near", std::numeric_limits<double>::quiet_NaN()),
            "/toy/near is nan, must be between 0 and 1000 m; using the default 1 m");
  EXPECT_EQ(problem("near", dictionary),
            "/toy/near is a dictionary, must be a number; using the default 1 m");
  EXPECT_EQ(problem("mode", "fat"),
            "/toy/mode is 'fat', must be one of slow, fast; using the default 'slow'");
  EXPECT_EQ(problem("label", 7), "/toy/label is 7, must be a text; using the default 'none'");
  EXPECT_EQ(problem("states", listOf(1, "a")),
            "/toy/states is '[1, a]', must be a list of whole numbers; using the default 0");
  EXPECT_EQ(problem("states", 256), "/toy/states is 256, must be between 0 and 255; using the default 0");
  EXPECT_EQ(problem("kinds", listOf(1)), "/toy/kinds is [1], must be a list of texts; using the default car");
  EXPECT_EQ(problem("lamps", 1), "/toy/lamps is 1, must be a dictionary: name -> parameters");
}

TEST(ReadParameters, BadEntryOfADictionaryIsLeftOut) {
  XmlRpcValue given;
  given["lamps"]["good"]["topic"] = "a";
  given["lamps"]["good"]["scale"] = -1;
  given["lamps"]["wide"]["topic"] = "b";
  given["lamps"]["wide"]["scale"] = 5;
  given["lamps"]["typo"]["topic"] = "c";
  given["lamps"]["typo"]["scal"] = -1;
  given["lamps"]["flat"] = "d";
  const Reading reading = read(given);
  ASSERT_EQ(reading.config.lamps.size(), 1U);
  EXPECT_EQ(reading.config.lamps.at("good").topic, "a");
  EXPECT_EQ(reading.config.lamps.at("good").scale, -1.0);
  EXPECT_EQ(
      reading.problems.lines,
      (std::vector<std::string>{"/toy/lamps/flat is 'd', must be a dictionary; flat is left out",
                                "/toy/lamps/typo/scal is unknown; did you mean 'scale'?; typo is left out",
                                "/toy/lamps/wide/scale is 5, must be between -2 and 2; wide is left out"}));
  EXPECT_TRUE(reading.problems.concern("lamps/typo"));
}

TEST(ReadParameters, UnknownNamesUnlessOthersReadThem) {
  ToyConfig config;
  XmlRpcValue given;
  given["mod"] = "fast";
  given["threshold"] = 1.0;
  given["lamp"]["front"]["topic"] = "a";
  given["diagnostic_period"] = 1.0;
  given["image_transport"] = "compressed";
  given["image"]["compressed"]["jpeg_quality"] = 80;
  given["lanes"] = 3;
  given["lamps"]["front"]["topic"] = "a";
  given["group"]["lanes"] = 2;
  EXPECT_EQ(unknownParameters(given, "/toy", fieldsOf(config)),
            (std::vector<std::string>{"'/toy/group/lanes' is not read; it belongs directly below '/toy'",
                                      "'/toy/lamp' is no parameter of this nodelet; did you mean 'lamps'?",
                                      "'/toy/mod' is no parameter of this nodelet; did you mean 'mode'?",
                                      "'/toy/threshold' is no parameter of this nodelet"}));
}

TEST(ReadParameters, RulesSendExactlyTheirFieldsBack) {
  ToyConfig config, defaults;
  config.near = 60.0;
  config.lanes = 5;
  config.lamps["dark"];
  config.lamps["lit"].topic = "a";
  ParameterProblems problems;
  EXPECT_TRUE(
      fallBackUntil([&] { validate(config); }, "/toy", fieldsOf(config), fieldsOf(defaults), problems));
  EXPECT_EQ(config.near, 1.0);
  EXPECT_EQ(config.lanes, 5);
  EXPECT_EQ(config.lamps.size(), 1U);
  EXPECT_EQ(problems.lines,
            (std::vector<std::string>{"/toy: near (60 m) must be smaller than far (50 m); using "
                                      "the default 1 m of near",
                                      "/toy: lamps/dark has no topic; lamps/dark is left out"}));
  EXPECT_EQ(problems.refused, (std::vector<std::string>{"near", "lamps/dark"}));
}

TEST(ReadParameters, RulesAreOptional) {
  ToyConfig config;
  config.near = 60.0;
  EXPECT_THROW(validateConfig(config), InvalidParameter);
  ToyLamp lamp;
  validateConfig(lamp);
  lamp.scale = 5.0;
  EXPECT_THROW(validateConfig(lamp), InvalidParameter);
}

TEST(ReadParameters, WhatNamesNoParameterSendsAllBack) {
  ToyConfig config, defaults;
  config.lanes = 5;
  config.frame = "axle";
  ParameterProblems problems;
  const auto attempt = [&config] {
    if (config.lanes == 5) throw std::runtime_error("out of memory");
  };
  EXPECT_TRUE(fallBackUntil(attempt, "/toy", fieldsOf(config), fieldsOf(defaults), problems));
  EXPECT_EQ(config.lanes, 2);
  EXPECT_EQ(config.frame, "axle") << "in use since the start";
  EXPECT_EQ(problems.text(), "/toy: out of memory; using defaults for all parameters");
  EXPECT_TRUE(problems.concern("lanes"));
}

TEST(ReadParameters, WhatFailsWithTheDefaultsTooIsReported) {
  ToyConfig config, defaults;
  ParameterProblems problems;
  const auto attempt = [] { throw InvalidParameter({"lanes"}, "lanes cannot be used"); };
  EXPECT_FALSE(fallBackUntil(attempt, "/toy", fieldsOf(config), fieldsOf(defaults), problems));
  EXPECT_EQ(problems.lines,
            (std::vector<std::string>{"/toy: lanes cannot be used; using defaults for all parameters",
                                      "/toy: lanes cannot be used, with the defaults too"}));
}

TEST(ReadParameters, WhatIsWrittenReadsBack) {
  ToyConfig config;
  config.states = {};
  config.kinds = {"a", "b"};
  config.near = 0.1 + 0.2;
  config.mode = Mode::kFast;
  XmlRpcValue given;
  for (const Field& field : fieldsOf(config)) {
    const XmlRpcValue value = toXmlRpc(field);
    if (value.valid()) given[field.name] = value;
  }
  EXPECT_FALSE(given.hasMember("tilt"));
  const Reading reading = read(given);
  EXPECT_EQ(reading.problems.text(), "");
  EXPECT_TRUE(sameFields(reading.config, config));
}

}  // namespace
}  // namespace radar_dot
