// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/reconfigure_messages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "fixtures/refusal.h"
#include "nodelets/toy_config.h"

namespace radar_dot {
namespace {

using dynamic_reconfigure::Config;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename Parameters>
auto valueOf(const Parameters& parameters, const std::string& name) {
  for (const auto& each : parameters)
    if (each.name == name) return each.value;
  ADD_FAILURE() << name << " is not in the message";
  return decltype(parameters.front().value)();
}

std::string describe(const dynamic_reconfigure::Group& group) {
  std::string text =
      group.name + " " + std::to_string(group.id) + " in " + std::to_string(group.parent) + ":";
  for (const auto& parameter : group.parameters) text += " " + parameter.name + " " + parameter.type;
  return text;
}

TEST(ReconfigureMessages, DescriptionHasGroupsTypesAndLimits) {
  ToyConfig defaults;
  const dynamic_reconfigure::ConfigDescription description = descriptionOf(fieldsOf(defaults));
  ASSERT_EQ(description.groups.size(), 3U);
  EXPECT_EQ(describe(description.groups[0]), "Default 0 in 0: lit bool lanes int houses int");
  EXPECT_EQ(describe(description.groups[1]),
            "Range_of_view 1 in 0: near double far double view double tilt str");
  // The parameter `filter` must not hide the group.
  EXPECT_EQ(describe(description.groups[2]),
            "Filter_parameters 2 in 0: mode str label str states str kinds str filter bool");
  EXPECT_EQ(description.groups[1].parameters[0].description, "Where it begins [m]");
  EXPECT_EQ(description.groups[0].parameters[0].edit_method, "");
  EXPECT_EQ(description.groups[2].parameters[0].edit_method,
            R"({'enum': [{'name': 'slow', 'type': 'str', 'value': 'slow', 'description': 'it\'s careful'}, )"
            R"({'name': 'fast', 'type': 'str', 'value': 'fast', 'description': 'a back\\slash'}], )"
            R"('enum_description': 'How it\'s done'})");
  EXPECT_EQ(valueOf(description.min.ints, "lanes"), 1);
  EXPECT_EQ(valueOf(description.max.ints, "lanes"), 8);
  EXPECT_EQ(valueOf(description.min.ints, "houses"), 0);
  EXPECT_EQ(valueOf(description.max.ints, "houses"), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(valueOf(description.max.doubles, "view"), kInfinity);
  EXPECT_EQ(valueOf(description.max.strs, "states"), "");
  EXPECT_EQ(valueOf(description.dflt.strs, "states"), "0");
  EXPECT_EQ(valueOf(description.dflt.strs, "mode"), "slow");
  for (const Config* config : {&description.min, &description.max, &description.dflt}) {
    EXPECT_EQ(config->bools.size() + config->ints.size() + config->doubles.size() + config->strs.size(), 12U);
    EXPECT_EQ(config->groups.size(), 3U);
  }
}

TEST(ReconfigureMessages, MessageReadsBack) {
  ToyConfig config;
  config.lit = false;
  config.houses = 0;
  config.near = 0.1 + 0.2;
  config.tilt = 0.25;
  config.mode = Mode::kFast;
  config.states = {0, 4};
  config.kinds = {"a", "b"};
  const Config message = messageOf(fieldsOf(config));
  EXPECT_EQ(valueOf(message.strs, "states"), "0, 4");
  EXPECT_EQ(valueOf(message.strs, "tilt"), "0.25");
  ToyConfig read;
  read.view = 1.0;
  EXPECT_EQ(writeRequest(message, fieldsOf(read)).size(), 12U);
  EXPECT_TRUE(sameFields(config, read));
}

TEST(ReconfigureMessages, RequestChangesOnlyWhatItNames) {
  ToyConfig config;
  config.near = 3.0;
  config.tilt = 0.5;
  Config request;
  request.ints.resize(2);
  request.ints[0].name = "lanes";
  request.ints[0].value = 4;
  request.ints[1].name = "far";
  request.ints[1].value = 20;
  request.strs.resize(1);
  request.strs[0].name = "tilt";
  EXPECT_EQ(writeRequest(request, fieldsOf(config)), (std::vector<std::string>{"lanes", "far", "tilt"}));
  EXPECT_EQ(config.lanes, 4);
  EXPECT_EQ(config.far, 20.0);
  EXPECT_EQ(config.near, 3.0);
  EXPECT_FALSE(config.tilt.has_value());
}

TEST(ReconfigureMessages, RefusedRequests) {
  const auto refusal = [](auto member, const char* name, const auto& value) {
    Config request;
    (request.*member).resize(1);
    (request.*member)[0].name = name;
    (request.*member)[0].value = value;
    ToyConfig config;
    return test::refusalOf<InvalidParameter>([&] { writeRequest(request, fieldsOf(config)); });
  };
  EXPECT_EQ(refusal(&Config::doubles, "near", -1.0), "near is -1, must be between 0 and 1000 m");
  EXPECT_EQ(refusal(&Config::ints, "lanes", 9), "lanes is 9, must be between 1 and 8");
  EXPECT_EQ(refusal(&Config::strs, "mode", "fat"), "mode is 'fat', must be one of slow, fast");
  EXPECT_EQ(refusal(&Config::strs, "states", "0, nine"),
            "states is '0, nine', must be a list of whole numbers");
  EXPECT_EQ(refusal(&Config::strs, "near", "2"), "near is '2', must be a number");
  EXPECT_EQ(refusal(&Config::bools, "lanes", std::uint8_t{1}), "lanes is 'true', must be a whole number");
  EXPECT_EQ(refusal(&Config::ints, "lit", 1), "lit is '1', must be true or false");
  EXPECT_EQ(refusal(&Config::ints, "lane", 1),
            "'lane' is no parameter of this nodelet; did you mean 'lanes'?");
  EXPECT_EQ(refusal(&Config::strs, "frame", "axle"),
            "frame is read at start, and cannot be changed while the nodelet runs");
}

}  // namespace
}  // namespace radar_dot
