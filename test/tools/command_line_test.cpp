// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/command_line.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "fixtures/field_values.h"
#include "fixtures/files.h"
#include "radar_dot/config/sections.h"
#include "tools/parameter_document.h"
#include "tools/result_files.h"

namespace radar_dot::tools {
namespace {

struct Input {
  std::string dataroot;
  std::vector<std::string> scenes;
  bool all = false;
  void describe(FieldList& fields) {
    fields.add("dataroot", dataroot, "Folder of the data set");
    fields.add("scenes", scenes, "Scenes by name; empty: all of them");
    fields.add("all", all, "All scenes");
  }
};

/// A tool with two of the sections, of which the first is used with a filter.
struct Tool {
  Configuration configuration;
  FieldList ego = fieldsOf(configuration.ego_velocity);
  FieldList objects = fieldsOf(configuration.moving_objects);
  Input input;
  ResultFiles output;
  CommandLine command_line;

  explicit Tool(const char* tool = "evaluate_toy")
      : command_line(tool, "Scores toys.", {"evaluate_toy --all"}) {
    objects.find("azimuth_std")->set(0.02);
    command_line.setSections(sectionsOf(configuration));
    command_line.add("Input", fieldsOf(input));
    command_line.add("Ego velocity", ego,
                     [](const radar_dot::Field& field) { return std::string(field.name) != "model"; });
    command_line.add("Objects", objects);
    command_line.addOutputs("Output", fieldsOf(output));
  }
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  FieldValue value(const char* name) const {
    const Field* field = ego.find(name);
    return (field != nullptr ? field : objects.find(name))->get();
  }
  std::optional<int> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "evaluate_toy");
    return command_line.parse(static_cast<int>(words.size()), words.data());
  }
};

struct Refusal {
  std::optional<int> exit_code;
  std::string text;
};

Refusal refusal(Tool& tool, const std::vector<const char*>& words) {
  testing::internal::CaptureStderr();
  const std::optional<int> exit_code = tool.parse(words);
  return {exit_code, testing::internal::GetCapturedStderr()};
}

void expectRefusal(const std::vector<const char*>& words, const std::string& text) {
  Tool tool;
  const Refusal result = refusal(tool, words);
  EXPECT_EQ(result.exit_code, kUsageError);
  EXPECT_EQ(result.text, "evaluate_toy: " + text + "\n");
}

TEST(CommandLine, SetsFieldsOfEveryType) {
  Tool tool;
  tool.input.all = true;
  tool.configuration.ego_velocity.extraction.doppler_field = "v";
  EXPECT_EQ(tool.parse({"--threshold", "2", "--ransac-iterations=7", "--solver", "least_squares",
                        "--no-neighbourhood", "--mask-starts-tracks", "--weak-threshold", "inf",
                        "--min-azimuth", "-1", "--invalid-states", "[1, 2]", "--scenes", "a,b",
                        "--doppler-field=", "--dataroot", "-", "--all=false"}),
            std::nullopt);
  const std::pair<const char*, FieldValue> expected[] = {
      {"threshold", 2.0},
      {"ransac_iterations", std::int64_t{7}},
      {"solver", std::string("least_squares")},
      {"neighbourhood", false},
      {"mask_starts_tracks", true},
      {"weak_threshold", std::numeric_limits<double>::infinity()},
      {"min_azimuth", -1.0},
      {"invalid_states", std::vector<int>{1, 2}},
      {"doppler_field", std::string()}};
  for (const auto& [name, value] : expected) EXPECT_EQ(tool.value(name), value) << name;
  EXPECT_EQ(tool.input.scenes, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(tool.input.dataroot, "-");
  EXPECT_FALSE(tool.input.all);
}

TEST(CommandLine, NegativeNumbersAsWordsAndAfterEquals) {
  for (const std::vector<const char*>& words :
       {std::vector<const char*>{"--min-azimuth", "-1.5e-1"}, {"--min-azimuth=-1.5e-1"}}) {
    Tool tool;
    EXPECT_EQ(tool.parse(words), std::nullopt);
    EXPECT_EQ(tool.value("min_azimuth"), FieldValue(-0.15));
  }
}

TEST(CommandLine, RefusesInOneLine) {
  const std::pair<std::vector<const char*>, const char*> refusals[] = {
      {{"--threshold", "1000"}, "--threshold is 1000, must be between 0.001 and 100 m/s"},
      {{"--solver", "magic"}, "--solver is 'magic', must be one of least_squares, ransac, ransac_robust"},
      {{"--ransac-iterations=1.5"}, "--ransac-iterations is '1.5', must be a whole number"},
      {{"--filter=perhaps"}, "--filter is 'perhaps', must be true or false"},
      {{"--treshold", "1"}, "unknown option --treshold; did you mean --threshold?"},
      {{"--azimuth_std=1"}, "unknown option --azimuth_std; did you mean --azimuth-std?"},
      {{"--no-filtr"}, "unknown option --no-filtr; did you mean --no-filter?"},
      {{"--zzzzzz"}, "unknown option --zzzzzz"},
      {{"--thresh", "1"}, "unknown option --thresh; did you mean --threshold?"},
      {{"elm"}, "'elm' belongs to no option"},
      {{"--scenes", "a", "b"}, "'b' belongs to no option; the items of a list are joined by commas"},
      {{"--filter", "false"}, "'false' belongs to no option"},
      {{"--threshold"}, "--threshold needs a value"},
      {{"--json", "--all"}, "--json needs a value"},
      {{"--json", "--al"}, "--json needs a value"},
      {{"--filter="}, "--filter needs a value after '='"},
      {{"--no-filter=true"}, "--no-filter takes no value"},
      {{"--help=1"}, "--help takes no value"},
      {{"--threshold", "1", "--threshold=2"}, "--threshold is given twice"},
      {{"--filter", "--no-filter"}, "--filter is given twice"},
      {{"--doppler-field", "a\nb", "--invalid-states", "x\ny"},
       "--invalid-states is 'x?y', must be a list of whole numbers"},
      // Without effect, or filtered.
      {{"--expected-rate", "1"}, "unknown option --expected-rate"},
      {{"--model", "planar"}, "unknown option --model"}};
  for (const auto& [words, text] : refusals) expectRefusal(words, std::string(text) + " (see --help)");
}

template <typename Value>
struct One {
  const char* name;
  Value value;
  const char* unit = "";
  Range range = {};
  void describe(FieldList& fields) { fields.add(name, value, "One", unit, range); }
};

TEST(CommandLine, OneNameOneMeaning) {
  Tool tool;
  EXPECT_EQ(tool.parse({"--azimuth-std", "0.5"}), std::nullopt);
  for (const FieldList* fields : {&tool.ego, &tool.objects})
    EXPECT_EQ(fields->find("azimuth_std")->get(), FieldValue(0.5));
  One<double> other{"azimuth_std", 0.5, "deg", {0.0, 1.0}};
  One<bool> help{"help", false}, negative{"no_filter", false};
  for (const FieldList& fields : {fieldsOf(other), fieldsOf(help), fieldsOf(negative)})
    EXPECT_THROW(tool.command_line.add("Other", fields), std::logic_error);
}

TEST(CommandLine, RequiredAndExcludedOptions) {
  Tool tool;
  tool.command_line.require("dataroot", "all", [&tool] { return !tool.input.all; });
  tool.command_line.exclude("scenes", "all");
  EXPECT_EQ(refusal(tool, {}).text,
            "evaluate_toy: --dataroot or --all must be given: Folder of the data set (see --help)\n");
  EXPECT_EQ(tool.parse({"--all"}), std::nullopt);
  EXPECT_EQ(refusal(tool, {"--all", "--scenes", "a"}).text,
            "evaluate_toy: --scenes excludes --all (see --help)\n");
  EXPECT_EQ(tool.parse({"--no-all", "--scenes", "a", "--dataroot", "b"}), std::nullopt);
  EXPECT_EQ(refusal(tool, {"--no-all", "--dataroot="}).exit_code, kUsageError);
  EXPECT_THROW(tool.command_line.require("nothing"), std::logic_error);
}

TEST(CommandLine, FilesInTheirOrderThenOptions) {
  const test::TemporaryFolder folder;
  const std::string first = (folder.path() / "first.yaml").string();
  const std::string second = (folder.path() / "second.yaml").string();
  test::writeFile(first,
                  "ego_velocity: {threshold: 1, ransac_iterations: 1, model: planar}\n"
                  "moving_objects: {max_distance: 1}\n");
  test::writeFile(second, "ego_velocity: {threshold: 2, ransac_iterations: 2}\n");
  Tool tool;
  EXPECT_EQ(tool.parse({"--threshold", "3", "--config", first.c_str(), "--config", second.c_str()}),
            std::nullopt);
  EXPECT_EQ(tool.value("threshold"), FieldValue(3.0));
  EXPECT_EQ(tool.value("ransac_iterations"), FieldValue(std::int64_t{2}));
  EXPECT_EQ(tool.value("max_distance"), FieldValue(1.0));
  EXPECT_EQ(tool.value("model"), FieldValue(std::string("planar")));
  for (const char* name : {"threshold", "max_distance", "max-distance"})
    EXPECT_TRUE(tool.command_line.given(name)) << name;
  EXPECT_FALSE(tool.command_line.given("azimuth_std"));
  EXPECT_TRUE(tool.command_line.givenMember(tool.ego.find("model")->address));
  EXPECT_THROW(tool.command_line.given("model"), std::logic_error) << "no option of the tool";

  test::writeFile(second, "moving_objects:\n  max_distance: 0\n");
  expectRefusal({"--config", second.c_str()},
                second + ":2: moving_objects/max_distance is 0, must be between 0.01 and 100 m");
}

TEST(CommandLine, RulesBetweenFieldsNameOptions) {
  const Tool tool;
  testing::internal::CaptureStderr();
  EXPECT_EQ(
      tool.command_line.refuse(InvalidParameter({"min_azimuth", "model"}, "min_azimuth (2 rad) and model")),
      kUsageError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "evaluate_toy: --min-azimuth (2 rad) and model (see --help)\n");
}

TEST(CommandLine, RulesBetweenFieldsNameThePlacesInFiles) {
  const test::TemporaryFolder folder;
  const std::string first = (folder.path() / "first.yaml").string();
  const std::string second = (folder.path() / "second.yaml").string();
  test::writeFile(first, "ego_velocity:\n  min_azimuth: 2\n  threshold: 1\n");
  test::writeFile(second, "ego_velocity: {max_azimuth: 1, model: planar}\n");
  Tool tool;
  ASSERT_EQ(tool.parse({"--config", first.c_str(), "--config", second.c_str(), "--threshold", "2"}),
            std::nullopt);
  const auto refusalOf = [&tool](const std::vector<std::string>& names) {
    testing::internal::CaptureStderr();
    tool.command_line.refuse(InvalidParameter(names, "bad"));
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(refusalOf({"min_azimuth", "max_azimuth"}),
            "evaluate_toy: bad; set in " + first + ":2 and " + second + ":1 (see --help)\n");
  EXPECT_EQ(refusalOf({"model"}), "evaluate_toy: bad; set in " + second + ":1 (see --help)\n")
      << "of the section, though no option of the tool";
  EXPECT_EQ(refusalOf({"threshold"}), "evaluate_toy: bad (see --help)\n") << "overridden";
}

TEST(CommandLine, AReportRepeatsItsRun) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "report.json").string();
  Tool tool;
  for (const FieldList& fields : {tool.ego, tool.objects, fieldsOf(tool.input)})
    for (const Field& field : fields)
      if (!field.live_only && field.name != std::string("model")) field.set(test::anotherValue(field));
  tool.ego.find("threshold")->set(0.1 + 0.2);
  tool.objects.find("weak_threshold")->set(std::numeric_limits<double>::infinity());
  RadarEntry& front = tool.configuration.ego_velocity.radars["front"];
  for (const Field& field : fieldsOf(front))
    if (!field.live_only) field.set(test::anotherValue(field));
  tool.configuration.ego_velocity.radars["rear"] = {};
  tool.input.dataroot = "/data/nu scenes: 1";
  tool.input.scenes = {"a, b", "\"c\"\n"};
  tool.output.json = "out.json";
  const std::string report =
      withParameters("{\n    \"scenes\": [1],\n    \"overall\": {}\n}\n", tool.command_line.parametersJson());
  test::writeFile(file, report);

  Tool again;
  EXPECT_EQ(again.parse({"--config", file.c_str()}), std::nullopt) << report;
  EXPECT_TRUE(sameValues(again.ego, tool.ego)) << report;
  EXPECT_TRUE(sameValues(again.objects, tool.objects)) << report;
  EXPECT_TRUE(sameFields(again.input, tool.input)) << report;
  EXPECT_EQ(again.output.json, "") << "a report does not bring back where it was written";
  EXPECT_EQ(again.command_line.parametersJson(), tool.command_line.parametersJson());
  EXPECT_TRUE(again.command_line.given("dataroot"));

  Tool other("evaluate_other");
  const Refusal result = refusal(other, {"--config", file.c_str()});
  EXPECT_EQ(result.exit_code, kUsageError);
  EXPECT_EQ(result.text,
            "evaluate_other: " + file + ":3: the report is of evaluate_toy, not of evaluate_other\n");
}

TEST(CommandLine, ParametersGoInFrontOfTheReport) {
  EXPECT_EQ(withParameters("{\n    \"a\": 1\n}\n", "{\n    \"tool\": \"x\"\n}"),
            "{\n    \"parameters\": {\n        \"tool\": \"x\"\n    },\n    \"a\": 1\n}\n");
  EXPECT_EQ(withParameters("{}", "{}"), "{\n    \"parameters\": {}\n}");
}

TEST(CommandLine, HelpIsForReading) {
  Tool tool;
  tool.configuration.ego_velocity.extraction.doppler_field = "v";
  tool.command_line.require("dataroot");
  testing::internal::CaptureStdout();
  EXPECT_EQ(tool.parse({"--help", "--zzz"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_EQ(help, tool.command_line.help());
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
  for (const char* part :
       {"Usage: evaluate_toy [--config FILE]... [OPTION]...\nScores toys.\n",
        "\n  --dataroot TEXT               Folder of the data set [required]\n",
        "\nEgo velocity / Estimator:\n",
        "\n  --ransac-iterations INTEGER   Hypotheses of the random sampling [between 1 and 1000000; "
        "default\n"
        "                                100]\n",
        "1 sigma of the bearing of a radar return [between 0 and 1 rad;\n"
        "                                default 0.0175 (Ego velocity), 0.02 (Objects)]\n",
        "\n  --solver NAME                 How the Doppler constraints are solved [default ransac_robust]\n"
        "                                  least_squares  every return weighs the same (LSQ of the paper)\n"
        "                                  ransac         consensus, then least squares on its inliers\n"
        "                                                 (LSQ+RANSAC of the paper)\n",
        "\n  --[no-]neighbourhood          Final", "\n  --all                         All scenes\n",
        "case [default v]\n", "\nExamples:\n  evaluate_toy --all\n"})
    EXPECT_NE(help.find(part), std::string::npos) << part << "\n" << help;
}

}  // namespace
}  // namespace radar_dot::tools
