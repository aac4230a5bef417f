// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/config_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "fixtures/field_values.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {
namespace {

class ConfigFile : public testing::Test {
 protected:
  std::map<const void*, std::string> read(const std::string& yaml) {
    test::writeFile(file(), yaml);
    return readConfigFile(file(), sectionsOf(configuration_));
  }
  std::string refusalOfFile(const std::string& path) {
    return test::refusalOf<ConfigFileError>([&] { readConfigFile(path, sectionsOf(configuration_)); });
  }
  /// The refusal without the name of the file.
  std::string refusalOf(const std::string& yaml) {
    test::writeFile(file(), yaml);
    const std::string text = refusalOfFile(file());
    EXPECT_EQ(text.rfind(file() + ":", 0), 0U) << text;
    return text.substr(std::min(file().size() + 1, text.size()));
  }
  void expectRefusals(const std::vector<std::pair<const char*, const char*>>& refusals) {
    for (const auto& [yaml, text] : refusals) EXPECT_EQ(refusalOf(yaml), text) << yaml;
  }
  std::string file() const { return (folder_.path() / "vehicle.yaml").string(); }

  test::TemporaryFolder folder_;
  Configuration configuration_;
};

TEST_F(ConfigFile, SetsEachKindOfParameter) {
  configuration_.ego_velocity.extraction.doppler_field = "v";
  const std::map<const void*, std::string> set = read(
      "# A vehicle\n"
      "ego_velocity:\n"
      "  threshold: 2\n"
      "  ransac_iterations: 7.0\n"
      "  solver: least_squares\n"
      "  model: 'spatial'\n"
      "  use_mask: 'yes'\n"
      "  min_azimuth: -1.5\n"
      "  invalid_states: \"1, 2\"\n"
      "  doppler_field: \"\"\n"
      "  radars:\n"
      "    front: {topic: points, doppler_scale: -1}\n"
      "    rear:\n"
      "moving_objects: {weak_threshold: .inf}\n"
      "depth: {radar_topics: [radar_front, 'a, b']}\n"
      "overlay:\n");
  EgoVelocityConfig& ego = configuration_.ego_velocity;
  const FieldList fields = fieldsOf(ego);
  const std::pair<const char*, FieldValue> expected[] = {{"threshold", 2.0},
                                                         {"ransac_iterations", std::int64_t{7}},
                                                         {"solver", std::string("least_squares")},
                                                         {"model", std::string("spatial")},
                                                         {"use_mask", true},
                                                         {"min_azimuth", -1.5},
                                                         {"invalid_states", std::vector<int>{1, 2}},
                                                         {"doppler_field", std::string()}};
  for (const auto& [name, value] : expected) EXPECT_EQ(fields.find(name)->get(), value) << name;
  EXPECT_EQ(fieldsOf(configuration_.moving_objects).find("weak_threshold")->get(),
            FieldValue(std::numeric_limits<double>::infinity()));
  EXPECT_EQ(configuration_.depth.radar_topics, (std::vector<std::string>{"radar_front", "a, b"}));
  ASSERT_EQ(ego.radars.size(), 2U);
  EXPECT_EQ(ego.radars.at("front").topic, "points");
  EXPECT_EQ(ego.radars.at("front").overrides.at("doppler_scale"), FieldValue(-1.0));
  EXPECT_EQ(ego.radars.at("rear").topic, RadarEntry().topic);
  EXPECT_EQ(set.at(fields.find("threshold")->address), file() + ":3");
  EXPECT_EQ(set.count(fields.find("azimuth_std")->address), 0U);
}

TEST_F(ConfigFile, EmptyFilesSectionsAndListsAreFine) {
  for (const char* yaml : {"", "# nothing\n", "ego_velocity:\ndepth: {}\n"}) read(yaml);
  EXPECT_TRUE(sameFields(configuration_.ego_velocity, EgoVelocityConfig()));
  read("ego_velocity: {invalid_states: []}\n");
  EXPECT_EQ(fieldsOf(configuration_.ego_velocity).find("invalid_states")->get(),
            FieldValue(std::vector<int>()));
}

TEST_F(ConfigFile, RefusesUnknownNames) {
  expectRefusals(
      {{"ego_velocty:\n  threshold: 1\n", "1: unknown section ego_velocty; did you mean ego_velocity?"},
       {"xyz: 1\n", "1: unknown section xyz"},
       {"ego_velocity:\n  threshold: 1\n  treshold: 1\n",
        "3: unknown parameter ego_velocity/treshold; did you mean threshold?"},
       {"ego_velocity:\n  radars:\n    front: {topik: a}\n",
        "3: unknown parameter ego_velocity/radars/front/topik; did you mean topic?"},
       {"options: {dataroot: a}\n", "1: unknown section options"}});
}

TEST_F(ConfigFile, RefusesValuesThatAreNotValid) {
  expectRefusals(
      {{"moving_objects:\n\n  max_distance: 0\n",
        "3: moving_objects/max_distance is 0, must be between 0.01 and 100 m"},
       {"ego_velocity:\n  solver: magic\n",
        "2: ego_velocity/solver is 'magic', must be one of least_squares, ransac, ransac_robust"},
       {"ego_velocity:\n  radars:\n    front: {doppler_scale: 50}\n",
        "3: ego_velocity/radars/front/doppler_scale is 50, must be between -10 and 10"},
       {"ego_velocity:\n  threshold: [1, 2]\n", "2: ego_velocity/threshold is '1, 2', must be a number"},
       {"ego_velocity:\n  threshold: {a: 2}\n", "2: ego_velocity/threshold is a dictionary, must be a value"},
       {"ego_velocity:\n  ransac_iterations: 7.5\n",
        "2: ego_velocity/ransac_iterations is '7.5', must be a whole number"},
       {"ego_velocity:\n  doppler_field: 5\n",
        "2: ego_velocity/doppler_field is 5 without quotes, must be a text"},
       {"depth:\n  radar_topics: [yes, b]\n",
        "2: depth/radar_topics is yes without quotes, must be a list of texts"},
       {"ego_velocity:\n  threshold:\n", "2: ego_velocity/threshold has no value"},
       {"ego_velocity:\n  invalid_states: [[1], 2]\n",
        "2: ego_velocity/invalid_states holds more than single values"},
       {"ego_velocity:\n  min_azimuth: deg(45)\n",
        "2: ego_velocity/min_azimuth is 'deg(45)'; deg() and rad() are not read here, write the number in "
        "rad"},
       {"ego_velocity:\n  min_azimuth: !degrees 45\n",
        "2: ego_velocity/min_azimuth has the tag !degrees; tags are not read here, write the plain value"},
       // What has no effect on a tool is checked too.
       {"ego_velocity: {expected_rate: 0}\n",
        "1: ego_velocity/expected_rate is 0, must be between 0.001 and 10000 Hz"}});
}

TEST_F(ConfigFile, RefusesAFileOfAnotherShape) {
  expectRefusals({{"depth:\n  max_depth: 1\n  max_depth: 2\n", "3: max_depth is there twice"},
                  {"depth:\nego_velocity:\ndepth:\n", "3: depth is there twice"},
                  {"depth: 5\n", "1: depth is no dictionary of names and values"},
                  {"- depth\n", "1: the file is no dictionary of names and values"},
                  {"depth: {[1, 2]: 3}\n", "1: depth has a key that is not a name"}});
  EXPECT_EQ(refusalOf("ego_velocity:\n  states: [1, 2\ndepth:\n").substr(0, 18), "3: not valid YAML:");
  for (const char* endless : {", depth: 1\n", "depth:\n---\n,\n"})
    EXPECT_NE(refusalOf(endless).find(": not valid YAML: "), std::string::npos) << endless;
}

TEST_F(ConfigFile, NamesAFileThatCannotBeRead) {
  for (const auto& [path, cause] : {std::pair<std::string, std::string>{"/nowhere.yaml", "No such file"},
                                    {folder_.path().string(), "directory"}}) {
    const std::string text = refusalOfFile(path);
    EXPECT_EQ(text.rfind("cannot read " + path + ": ", 0), 0U) << text;
    EXPECT_NE(text.find(cause), std::string::npos) << text;
  }
}

TEST_F(ConfigFile, ReadsEachParameterAndRefusesWhatIsNotValid) {
  for (const Section& section : sectionsOf(configuration_)) {
    for (const Field& field : section.fields) {
      const std::string name = std::string(section.name) + "/" + field.name;
      const auto yaml = [&](const FieldValue& value) {
        const bool is_list = std::holds_alternative<std::vector<std::string>>(value);
        return std::string(section.name) + ": {" + field.name + ": " +
               (is_list ? "[" + toText(value) + "]}" : "'" + toText(value) + "'}");
      };
      const FieldValue value = test::anotherValue(field);
      EXPECT_NE(value, field.get()) << name;
      read(yaml(value));
      EXPECT_EQ(field.get(), value) << name;
      for (const FieldValue& wrong : test::wrongValues(field)) {
        EXPECT_NE(refusalOf(yaml(wrong)).find(name), std::string::npos) << name << " " << toText(wrong);
        EXPECT_EQ(field.get(), value) << name;
      }
    }
  }
}

}  // namespace
}  // namespace radar_dot
