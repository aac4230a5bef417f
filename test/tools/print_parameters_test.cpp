// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The parameters of the nodelets as files and as options.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/tool_run.h"
#include "radar_dot/config/sections.h"
#include "tools/command_line.h"
#include "tools/config_file.h"
#include "tools/field_values.h"
#include "tools/parameter_document.h"

namespace radar_dot::tools {
namespace {

bool sameSections(const std::vector<Section>& a, const std::vector<Section>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Section& x, const Section& y) { return sameValues(x.fields, y.fields); });
}

/// Of everything another value than the default.
void change(const std::vector<Section>& sections) {
  for (const Section& section : sections) {
    for (const Field& field : section.fields) {
      const FieldValue value = test::anotherValue(field);
      EXPECT_NE(value, field.get()) << section.name << "/" << field.name;
      field.set(value);
    }
  }
}

TEST(PrintParameters, TheTemplateHoldsTheDefaults) {
  const auto [exit_code, text] = test::runCommand(TOOL);
  ASSERT_EQ(exit_code, 0) << text;
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "vehicle.yaml").string();
  test::writeFile(file, text);
  Configuration read, defaults;
  change(sectionsOf(read));
  // Optional numbers cannot be unset by a file.
  for (const Section& section : sectionsOf(read)) {
    const std::vector<Section> others = sectionsOf(defaults);
    for (const Section& other : others)
      if (section.name == std::string(other.name))
        for (const Field& field : section.fields)
          if (std::holds_alternative<std::monostate>(other.fields.find(field.name)->get()))
            field.put(FieldValue());
  }
  readConfigFile(file, sectionsOf(read));
  EXPECT_TRUE(sameSections(sectionsOf(read), sectionsOf(defaults)));
}

TEST(PrintParameters, EachParameterReadsBackFromAFile) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "vehicle.yaml").string();
  Configuration changed, read;
  change(sectionsOf(changed));
  test::writeFile(file, parametersYaml(sectionsOf(changed)));
  readConfigFile(file, sectionsOf(read));
  EXPECT_TRUE(sameSections(sectionsOf(read), sectionsOf(changed)));
}

TEST(PrintParameters, EachParameterIsAnOptionUnlessItIsLiveOnly) {
  Configuration configuration;
  for (const Section& section : sectionsOf(configuration)) {
    CommandLine command_line("tool", "", {});
    command_line.add(section.name, section.fields);
    for (const Field& field : section.fields) {
      if (field.live_only) continue;
      std::string name = std::string("--") + field.name;
      std::replace(name.begin(), name.end(), '_', '-');
      const FieldValue value = test::anotherValue(field);
      const std::string word = name + "=" + toText(value);
      const char* const words[] = {"tool", word.c_str()};
      EXPECT_EQ(command_line.parse(2, words), std::nullopt) << word;
      EXPECT_EQ(field.get(), value) << word;
      const std::optional<std::string> invalid = test::invalidText(field);
      if (!invalid) continue;
      const std::string wrong = name + "=" + *invalid;
      const char* const wrong_words[] = {"tool", wrong.c_str()};
      testing::internal::CaptureStderr();
      EXPECT_EQ(command_line.parse(2, wrong_words), kUsageError) << wrong;
      EXPECT_EQ(testing::internal::GetCapturedStderr().rfind("tool: " + name + " is ", 0), 0U) << wrong;
    }
  }
}

TEST(PrintParameters, TheFilesInTheFolderConfigAreValid) {
  for (const auto& file : std::filesystem::directory_iterator(CONFIG_FOLDER)) {
    Configuration configuration;
    EXPECT_NO_THROW(readConfigFile(file.path().string(), sectionsOf(configuration))) << file.path();
    EXPECT_NO_THROW(validate(configuration)) << file.path();
  }
}

TEST(PrintParameters, TheDocumentIsUpToDate) {
  const auto [exit_code, text] = test::runCommand(std::string(TOOL) + " --markdown");
  EXPECT_EQ(exit_code, 0);
  EXPECT_EQ(text, test::readFile(DOCUMENT)) << "run print_parameters --markdown > docs/parameters.md";
}

}  // namespace
}  // namespace radar_dot::tools
