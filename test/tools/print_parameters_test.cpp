// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The parameters of the nodelets as files and as options.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "config/config_file.h"
#include "fixtures/field_values.h"
#include "fixtures/files.h"
#include "fixtures/tool_run.h"
#include "radar_dot/config/sections.h"
#include "tools/command_line.h"
#include "tools/parameter_document.h"

namespace radar_dot::tools {
namespace {

class PrintParameters : public testing::Test {
 protected:
  /// Of everything another value than the default.
  void change() {
    for (const Section& section : sectionsOf(changed_)) {
      for (const Field& field : section.fields) {
        const FieldValue value = test::anotherValue(field);
        EXPECT_NE(value, field.get()) << section.name << "/" << field.name;
        if (!field.optional) field.set(value);  // no file unsets one
      }
    }
  }
  void expectFileMakes(const std::string& yaml, Configuration start, Configuration& expected) {
    const test::TemporaryFolder folder;
    const std::string file = (folder.path() / "vehicle.yaml").string();
    test::writeFile(file, yaml);
    readConfigFile(file, sectionsOf(start));
    const std::vector<Section> a = sectionsOf(start), b = sectionsOf(expected);
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_TRUE(sameValues(a[i].fields, b[i].fields)) << a[i].name << "\n" << yaml;
  }

  Configuration changed_, defaults_;
};

void expectParts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST_F(PrintParameters, TheTemplateHoldsTheDefaults) {
  const auto [exit_code, text] = test::runCommand(TOOL);
  ASSERT_EQ(exit_code, 0) << text;
  change();
  expectFileMakes(text, changed_, defaults_);
}

TEST_F(PrintParameters, EachParameterReadsBackFromAFile) {
  change();
  RadarEntry& front = changed_.ego_velocity.radars["front"];
  for (const Field& field : fieldsOf(front)) field.set(test::anotherValue(field));
  changed_.ego_velocity.radars["on"].topic = "a: 'b' # c";
  expectFileMakes(parametersYaml(sectionsOf(changed_)), defaults_, changed_);
}

TEST_F(PrintParameters, EachParameterIsAnOptionUnlessItIsLiveOnly) {
  for (const Section& section : sectionsOf(changed_)) {
    CommandLine command_line("tool", "", {});
    command_line.add(section.name, section.fields);
    for (const Field& field : section.fields) {
      if (field.live_only) continue;
      std::string name = std::string("--") + field.name;
      std::replace(name.begin(), name.end(), '_', '-');
      const auto parse = [&](const FieldValue& value) {
        const std::string word = name + "=" + toText(value);
        const char* const words[] = {"tool", word.c_str()};
        return command_line.parse(2, words);
      };
      const FieldValue value = test::anotherValue(field);
      EXPECT_EQ(parse(value), std::nullopt) << name;
      EXPECT_EQ(field.get(), value) << name;
      for (const FieldValue& wrong : test::wrongValues(field)) {
        testing::internal::CaptureStderr();
        EXPECT_EQ(parse(wrong), kUsageError) << name << " " << toText(wrong);
        EXPECT_EQ(testing::internal::GetCapturedStderr().rfind("tool: " + name + " is ", 0), 0U) << name;
        EXPECT_EQ(field.get(), value) << name;
      }
    }
  }
}

TEST_F(PrintParameters, TheFilesInTheFolderConfigAreValid) {
  for (const auto& file : std::filesystem::directory_iterator(CONFIG_FOLDER)) {
    const std::string name = file.path().filename().string();
    const bool is_foreign =
        name == "robot_localization.yaml" || name == "diagnostics.yaml";  // of other programs
    if (file.path().extension() != ".yaml" || is_foreign) continue;
    Configuration configuration;
    EXPECT_NO_THROW(readConfigFile(file.path().string(), sectionsOf(configuration))) << file.path();
    EXPECT_NO_THROW(validate(configuration)) << file.path();
  }
}

TEST_F(PrintParameters, TheDocumentIsUpToDate) {
  const auto [exit_code, text] = test::runCommand(std::string(TOOL) + " --markdown");
  EXPECT_EQ(exit_code, 0);
  EXPECT_EQ(text, test::readFile(DOCUMENT)) << "run print_parameters --markdown > docs/parameters.md";
}

TEST_F(PrintParameters, TheTemplateSaysWhatThereIsToKnow) {
  expectParts(
      parametersYaml(sectionsOf(defaults_)),
      {"\nego_velocity:\n  # --- Radars ---\n"
       "  # Age of the oldest scan of a sweep relative to its newest [between 0.001 and 10 s; at start]\n"
       "  window: 0.1\n",
       "\n  # How the Doppler constraints are solved\n"
       "  #   least_squares: every return weighs the same (LSQ of the paper)\n",
       "\n  solver: ransac_robust\n", " [0 m/s or more]\n  weak_threshold: 0.5\n", "\n  max_azimuth: .inf\n",
       "\n  # Longest gap between two twists that is integrated over [between 0.01 and 60 s; live only]\n",
       "\n  # radars:\n  #   name:\n"});
  EXPECT_TRUE(defaults_.ego_velocity.radars.empty()) << "the entry that is shown is made to be shown";
  defaults_.ego_velocity.radars["front"].topic = "points";
  expectParts(parametersYaml(sectionsOf(defaults_)),
              {"\n  radars:\n    front:\n", "\n      topic: points\n", "\n      # mount_xyz:\n",
               "\n      # Each of these parameters of the section can be set here instead: doppler_field, "});
}

TEST_F(PrintParameters, TablesOfTheParameters) {
  expectParts(
      parametersMarkdown(sectionsOf(defaults_)),
      {"\n## ego_velocity\n\nNodelet `EgoVelocity`.\n\n### Radars\n\n| name | unit |",
       "| `inlier_threshold` | m/s | `0.3` | between 0.001 and 100 m/s | Residual below which a return "
       "supports a hypothesis |\n",
       "| `solver` |  | `ransac_robust` | `least_squares`, `ransac`, `ransac_robust` | How the Doppler "
       "constraints are solved<br>`least_squares`: every",
       "| `mount_xyz` | m | not set | 3 numbers between -1000 and 1000 m |",
       "| `doppler_field` |  | empty |  |",
       "\n\nEach of these parameters of the section can be set here instead: `doppler_field`, ",
       " relative to its newest (*at start*) |", " integrated over (*live only*) |",
       "| Residual \\|d + u.v\\| between",
       "### `radars`\n\nThe radars: name -> parameters of each. Of each, by name:\n\n| name |",
       "| `topic` |  | empty |"});
}

}  // namespace
}  // namespace radar_dot::tools
