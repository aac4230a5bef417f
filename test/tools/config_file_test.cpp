// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/config_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "fixtures/files.h"
#include "tools/field_values.h"
#include "tools/parameter_document.h"
#include "tools/toy_sections.h"

namespace radar_dot::tools {
namespace {

using test::ToyConfiguration;

class ConfigFile : public testing::Test {
 protected:
  std::vector<const void*> read(const std::string& yaml) {
    test::writeFile(file(), yaml);
    return readConfigFile(file(), configuration_.sections());
  }
  /// The refusal without the name of the file.
  std::string refusalOf(const std::string& yaml) {
    try {
      read(yaml);
    } catch (const ConfigFileError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind(file() + ":", 0), 0U) << text;
      return text.substr(file().size() + 1);
    }
    return "accepted";
  }
  std::string file() const { return (folder_.path() / "vehicle.yaml").string(); }

  test::TemporaryFolder folder_;
  ToyConfiguration configuration_;
  test::ToyVelocity& velocity_ = configuration_.velocity;
};

TEST_F(ConfigFile, SetsEachKindOfParameter) {
  const std::vector<const void*> set = read(
      "# A vehicle\n"
      "ego_velocity:\n"
      "  threshold: 2\n"
      "  iterations: 7\n"
      "  solver: least_squares\n"
      "  side: 'right'\n"
      "  refine: yes\n"
      "  farthest: .inf\n"
      "  min_azimuth: -1.5\n"
      "  states: \"1, 2\"\n"
      "  channels: [radar_front, 'a, b']\n"
      "  frame: \"\"\n"
      "  radars:\n"
      "    front: {topic: points, doppler_scale: -1}\n"
      "    rear:\n"
      "depth:\n");
  EXPECT_EQ(velocity_.threshold, 2.0);
  EXPECT_EQ(velocity_.iterations, 7);
  EXPECT_EQ(velocity_.solver, Solver::kLeastSquares);
  EXPECT_EQ(velocity_.side, Side::kRight);
  EXPECT_TRUE(velocity_.refine);
  EXPECT_EQ(velocity_.farthest, std::numeric_limits<double>::infinity());
  EXPECT_EQ(velocity_.min_azimuth, -1.5);
  EXPECT_EQ(velocity_.states, (std::vector<int>{1, 2}));
  EXPECT_EQ(velocity_.channels, (std::vector<std::string>{"radar_front", "a, b"}));
  EXPECT_EQ(velocity_.frame, "");
  ASSERT_EQ(velocity_.radars.size(), 2U);
  EXPECT_EQ(velocity_.radars.at("front").topic, "points");
  EXPECT_EQ(velocity_.radars.at("front").doppler_scale, -1.0);
  EXPECT_EQ(velocity_.radars.at("rear").topic, "radar");
  EXPECT_NE(std::find(set.begin(), set.end(), &velocity_.threshold), set.end());
  EXPECT_EQ(std::find(set.begin(), set.end(), &velocity_.azimuth_std), set.end());
}

TEST_F(ConfigFile, EmptyFilesSectionsAndListsAreFine) {
  read("");
  read("# nothing\n");
  read("ego_velocity:\ndepth: {}\n");
  EXPECT_TRUE(sameFields(velocity_, test::ToyVelocity()));
  read("ego_velocity: {states: []}\n");
  EXPECT_TRUE(velocity_.states.empty());
}

TEST_F(ConfigFile, RefusesUnknownNames) {
  EXPECT_EQ(refusalOf("ego_velocty:\n  threshold: 1\n"),
            "1: unknown section ego_velocty; did you mean ego_velocity?");
  EXPECT_EQ(refusalOf("xyz: 1\n"), "1: unknown section xyz");
  EXPECT_EQ(refusalOf("ego_velocity:\n  threshold: 1\n  treshold: 1\n"),
            "3: unknown parameter ego_velocity/treshold; did you mean threshold?");
  EXPECT_EQ(refusalOf("ego_velocity:\n  radars:\n    front: {topik: a}\n"),
            "3: unknown parameter ego_velocity/radars/front/topik; did you mean topic?");
  EXPECT_EQ(refusalOf("options: {dataroot: a}\n"), "1: unknown section options");
}

TEST_F(ConfigFile, RefusesValuesThatAreNotValid) {
  EXPECT_EQ(refusalOf("depth:\n\n  max_depth: 0\n"),
            "3: depth/max_depth is 0, must be between 1 and 10000 m");
  EXPECT_EQ(refusalOf("ego_velocity:\n  solver: magic\n"),
            "2: ego_velocity/solver is 'magic', must be one of least_squares, ransac");
  EXPECT_EQ(refusalOf("ego_velocity:\n  radars:\n    front: {doppler_scale: 50}\n"),
            "3: ego_velocity/radars/front/doppler_scale is 50, must be between -10 and 10");
  EXPECT_EQ(refusalOf("ego_velocity:\n  threshold: [1, 2]\n"),
            "2: ego_velocity/threshold is '1, 2', must be a number");
  EXPECT_EQ(refusalOf("ego_velocity:\n  threshold: {a: 2}\n"),
            "2: ego_velocity/threshold is a dictionary, must be a value");
  EXPECT_EQ(refusalOf("ego_velocity:\n  threshold:\n"), "2: ego_velocity/threshold has no value");
  EXPECT_EQ(refusalOf("ego_velocity:\n  states: [[1], 2]\n"),
            "2: ego_velocity/states holds more than single values");
  EXPECT_EQ(
      refusalOf("ego_velocity:\n  min_azimuth: deg(45)\n"),
      "2: ego_velocity/min_azimuth is 'deg(45)'; deg() and rad() are not read here, write the number in "
      "rad");
  EXPECT_EQ(
      refusalOf("ego_velocity:\n  min_azimuth: !degrees 45\n"),
      "2: ego_velocity/min_azimuth has the tag !degrees; tags are not read here, write the plain value");
  // What has no effect on a tool is checked too.
  EXPECT_EQ(refusalOf("ego_velocity: {expected_rate: 0}\n"),
            "1: ego_velocity/expected_rate is 0, must be between 0.1 and 1000 Hz");
}

TEST_F(ConfigFile, RefusesAFileOfAnotherShape) {
  EXPECT_EQ(refusalOf("depth:\n  max_depth: 1\n  max_depth: 2\n"), "3: max_depth is there twice");
  EXPECT_EQ(refusalOf("depth:\nego_velocity:\ndepth:\n"), "3: depth is there twice");
  EXPECT_EQ(refusalOf("depth: 5\n"), "1: depth is no dictionary of names and values");
  EXPECT_EQ(refusalOf("- depth\n"), "1: the file is no dictionary of names and values");
  EXPECT_EQ(refusalOf("depth: {[1, 2]: 3}\n"), "1: depth has a key that is not a name");
  EXPECT_EQ(refusalOf("ego_velocity:\n  states: [1, 2\ndepth:\n").substr(0, 18), "3: not valid YAML:");
}

TEST_F(ConfigFile, NamesAFileThatCannotBeRead) {
  for (const auto& [path, cause] : {std::pair<std::string, std::string>{"/nowhere.yaml", "No such file"},
                                    {folder_.path().string(), "directory"}}) {
    try {
      readConfigFile(path, configuration_.sections());
      FAIL() << "accepted";
    } catch (const ConfigFileError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind("cannot read " + path + ": ", 0), 0U) << text;
      EXPECT_NE(text.find(cause), std::string::npos) << text;
    }
  }
}

TEST_F(ConfigFile, ReadsEachParameterAndRefusesWhatIsNotValid) {
  for (const Section& section : configuration_.sections()) {
    for (const Field& field : section.fields) {
      const std::string key = std::string(section.name) + ": {" + field.name + ": ";
      const FieldValue value = test::anotherValue(field);
      EXPECT_NE(value, field.get()) << field.name;
      const bool is_list = std::holds_alternative<std::vector<std::string>>(value);
      read(key + (is_list ? "[" + toText(value) + "]}" : "'" + toText(value) + "'}"));
      EXPECT_EQ(field.get(), value) << field.name;
      if (const std::optional<std::string> text = test::invalidText(field)) {
        EXPECT_NE(refusalOf(key + *text + "}").find(std::string(section.name) + "/" + field.name),
                  std::string::npos)
            << field.name;
        EXPECT_EQ(field.get(), value) << field.name;
      }
    }
  }
}

TEST_F(ConfigFile, ReadsBackTheTemplate) {
  for (const Section& section : configuration_.sections())
    for (const Field& field : section.fields) field.set(test::anotherValue(field));
  velocity_.radars["front"].doppler_scale = -1e-7;
  velocity_.radars["on"].topic = "a: 'b' # c";
  const std::string yaml = parametersYaml(configuration_.sections());
  const ToyConfiguration before = configuration_;
  configuration_ = {};
  read(yaml);
  EXPECT_TRUE(sameFields(before.velocity, configuration_.velocity)) << yaml;
  EXPECT_TRUE(sameFields(before.depth, configuration_.depth)) << yaml;
}

TEST(ParameterDocument, TemplateSaysWhatThereIsToKnow) {
  ToyConfiguration configuration;
  const std::string yaml = parametersYaml(configuration.sections());
  const auto has = [&yaml](const std::string& part) {
    EXPECT_NE(yaml.find(part), std::string::npos) << part << "\n" << yaml;
  };
  has("\nego_velocity:\n  # --- Estimate ---\n"
      "  # Residual of a return that moves [between 0.001 and 100 m/s]\n  threshold: 0.5\n");
  has("\n  # How the velocity is found\n  #   least_squares: All returns, as they are\n");
  has("\n  solver: ransac\n");
  has("\n  # Farther returns are left out [0 m or more; at start]\n  farthest: .inf\n");
  has("\n  # Begin of the field of view [between -3.2 and 3.2 rad; at start]\n  # min_azimuth:\n");
  has("\n  # Rate of the clouds [between 0.1 and 1000 Hz; live only]\n");
  has("\n  # radars:\n  #   name:\n");
  EXPECT_TRUE(configuration.velocity.radars.empty()) << "the entry that is shown is made to be shown";
}

TEST(ParameterDocument, TablesOfTheParameters) {
  ToyConfiguration configuration;
  const std::string text = parametersMarkdown(configuration.sections());
  const auto has = [&text](const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  };
  has("\n## ego_velocity\n\nNodelet `radar_dot/EgoVelocity`.\n\n### Estimate\n\n| name | unit |");
  has("| `threshold` | m/s | `0.5` | between 0.001 and 100 m/s | Residual of a return that moves |\n");
  has("| `solver` |  | `ransac` | `least_squares`, `ransac` | How the velocity is found<br>`least_squares`: "
      "All");
  has("| `min_azimuth` | rad | not set | between -3.2 and 3.2 rad | Begin of the field of view (*at start*) "
      "|");
  has("| `channels` |  | empty |  | Radars; empty: all (*at start*) |");
  has("Rate of the clouds (*live only*)");
  has("### `radars`\n\nRadars by name. Of each, by name:\n\n| name |");
  has("| `topic` |  | `radar` |");
}

}  // namespace
}  // namespace radar_dot::tools
