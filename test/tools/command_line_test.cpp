// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "fixtures/files.h"
#include "tools/field_values.h"
#include "tools/parameter_document.h"
#include "tools/toy_sections.h"

namespace radar_dot::tools {
namespace {

using test::ToyConfiguration;

/// A tool with two sections, of which the first is used with a filter.
struct Toy {
  ToyConfiguration configuration;
  test::ToyInput input;
  test::ToyOutput output;
  CommandLine command_line{
      "evaluate_toy", "Scores toys.", {"evaluate_toy --dataroot DIR", "evaluate_toy --all"}};

  explicit Toy(const char* tool = "evaluate_toy")
      : command_line(tool, "Scores toys.", {"evaluate_toy --all"}) {
    command_line.setSections(configuration.sections());
    command_line.add("Input", fieldsOf(input));
    command_line.add("Ego velocity", fieldsOf(configuration.velocity), except({"side"}));
    command_line.add("Depth", fieldsOf(configuration.depth));
    command_line.addOutputs("Output", fieldsOf(output));
  }
  Toy(const Toy&) = delete;
  Toy& operator=(const Toy&) = delete;

  std::optional<int> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "evaluate_toy");
    return command_line.parse(static_cast<int>(words.size()), words.data());
  }
};

struct Refusal {
  std::optional<int> exit_code;
  std::string text;
};

Refusal refusal(Toy& toy, const std::vector<const char*>& words) {
  testing::internal::CaptureStderr();
  const std::optional<int> exit_code = toy.parse(words);
  return {exit_code, testing::internal::GetCapturedStderr()};
}

void expectRefusal(const std::vector<const char*>& words, const std::string& text) {
  Toy toy;
  const Refusal result = refusal(toy, words);
  EXPECT_EQ(result.exit_code, kUsageError);
  EXPECT_EQ(result.text, "evaluate_toy: " + text + "\n");
}

TEST(CommandLine, SetsFieldsOfEveryType) {
  Toy toy;
  EXPECT_EQ(
      toy.parse({"--threshold", "2", "--iterations=7", "--solver", "least_squares", "--no-neighbourhood",
                 "--refine", "--farthest", "inf", "--min-azimuth", "-1", "--states", "[1, 2]", "--channels",
                 "a,b", "--frame=", "--dataroot", "-", "--all=false"}),
      std::nullopt);
  const test::ToyVelocity& velocity = toy.configuration.velocity;
  EXPECT_EQ(velocity.threshold, 2.0);
  EXPECT_EQ(velocity.iterations, 7);
  EXPECT_EQ(velocity.solver, Solver::kLeastSquares);
  EXPECT_FALSE(velocity.neighbourhood);
  EXPECT_TRUE(velocity.refine);
  EXPECT_EQ(velocity.farthest, std::numeric_limits<double>::infinity());
  EXPECT_EQ(velocity.min_azimuth, -1.0);
  EXPECT_EQ(velocity.states, (std::vector<int>{1, 2}));
  EXPECT_EQ(velocity.channels, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(velocity.frame, "");
  EXPECT_EQ(toy.input.dataroot, "-");
  EXPECT_FALSE(toy.input.all);
}

TEST(CommandLine, NegativeNumbersAsWordsAndAfterEquals) {
  for (const std::vector<const char*>& words :
       {std::vector<const char*>{"--min-azimuth", "-1.5e-1"}, {"--min-azimuth=-1.5e-1"}}) {
    Toy toy;
    EXPECT_EQ(toy.parse(words), std::nullopt);
    EXPECT_EQ(toy.configuration.velocity.min_azimuth, -0.15);
  }
}

TEST(CommandLine, RefusesInOneLine) {
  expectRefusal({"--threshold", "1000"},
                "--threshold is 1000, must be between 0.001 and 100 m/s (see --help)");
  expectRefusal({"--solver", "magic"},
                "--solver is 'magic', must be one of least_squares, ransac (see --help)");
  expectRefusal({"--iterations=1.5"}, "--iterations is '1.5', must be a whole number (see --help)");
  expectRefusal({"--refine=perhaps"}, "--refine is 'perhaps', must be true or false (see --help)");
  expectRefusal({"--treshold", "1"}, "unknown option --treshold; did you mean --threshold? (see --help)");
  expectRefusal({"--azimuth_std=1"},
                "unknown option --azimuth_std; did you mean --azimuth-std? (see --help)");
  expectRefusal({"--no-refin"}, "unknown option --no-refin; did you mean --no-refine? (see --help)");
  expectRefusal({"--zzzzzz"}, "unknown option --zzzzzz (see --help)");
  expectRefusal({"--thresh", "1"}, "unknown option --thresh; did you mean --threshold? (see --help)");
  expectRefusal({"elm"}, "'elm' belongs to no option (see --help)");
  expectRefusal({"--scenes", "a", "b"},
                "'b' belongs to no option; the items of a list are joined by commas (see --help)");
  expectRefusal({"--refine", "false"}, "'false' belongs to no option (see --help)");
  expectRefusal({"--threshold"}, "--threshold needs a value (see --help)");
  expectRefusal({"--json", "--all"}, "--json needs a value (see --help)");
  expectRefusal({"--json", "--al"}, "--json needs a value (see --help)");
  expectRefusal({"--no-refine=true"}, "--no-refine takes no value (see --help)");
  expectRefusal({"--threshold", "1", "--threshold=2"}, "--threshold is given twice (see --help)");
  expectRefusal({"--refine", "--no-refine"}, "--refine is given twice (see --help)");
  expectRefusal({"--frame", "a\nb", "--states", "x\ny"},
                "--states is 'x?y', must be a list of whole numbers (see --help)");
}

TEST(CommandLine, WhatHasNoEffectOrIsFilteredIsNoOption) {
  expectRefusal({"--expected-rate", "1"}, "unknown option --expected-rate (see --help)");
  expectRefusal({"--side", "left"}, "unknown option --side (see --help)");
}

TEST(CommandLine, OneNameOneMeaning) {
  Toy toy;
  EXPECT_EQ(toy.parse({"--azimuth-std", "0.5"}), std::nullopt);
  EXPECT_EQ(toy.configuration.velocity.azimuth_std, 0.5);
  EXPECT_EQ(toy.configuration.depth.azimuth_std, 0.5);

  struct Other {
    double azimuth_std = 0.5;
    void describe(FieldList& fields) { fields.add("azimuth_std", azimuth_std, "1 sigma", "deg", {0.0, 1.0}); }
  } other;
  EXPECT_THROW(toy.command_line.add("Other", fieldsOf(other)), std::logic_error);
  struct Helpful {
    bool help = false;
    void describe(FieldList& fields) { fields.add("help", help, "Help"); }
  } helpful;
  EXPECT_THROW(toy.command_line.add("Other", fieldsOf(helpful)), std::logic_error);
  struct Negative {
    bool no_refine = false;
    void describe(FieldList& fields) { fields.add("no_refine", no_refine, "Not"); }
  } negative;
  EXPECT_THROW(toy.command_line.add("Other", fieldsOf(negative)), std::logic_error);
}

TEST(CommandLine, RequiredAndExcludedOptions) {
  Toy toy;
  toy.command_line.require("dataroot", "all", [&toy] { return !toy.input.all; });
  toy.command_line.exclude("scenes", "all");
  EXPECT_EQ(refusal(toy, {}).text,
            "evaluate_toy: --dataroot or --all must be given: Folder of the data set (see --help)\n");
  EXPECT_EQ(toy.parse({"--all"}), std::nullopt);
  EXPECT_EQ(refusal(toy, {"--all", "--scenes", "a"}).text,
            "evaluate_toy: --scenes excludes --all (see --help)\n");
  EXPECT_EQ(toy.parse({"--no-all", "--scenes", "a", "--dataroot", "b"}), std::nullopt);
  EXPECT_EQ(refusal(toy, {"--no-all", "--dataroot="}).exit_code, kUsageError);
  EXPECT_THROW(toy.command_line.require("nothing"), std::logic_error);
}

TEST(CommandLine, FilesInTheirOrderThenOptions) {
  const test::TemporaryFolder folder;
  const std::string first = (folder.path() / "first.yaml").string();
  const std::string second = (folder.path() / "second.yaml").string();
  test::writeFile(first, "ego_velocity: {threshold: 1, iterations: 1, side: right}\ndepth: {max_depth: 1}\n");
  test::writeFile(second, "ego_velocity: {threshold: 2, iterations: 2}\n");
  Toy toy;
  EXPECT_EQ(toy.parse({"--threshold", "3", "--config", first.c_str(), "--config", second.c_str()}),
            std::nullopt);
  EXPECT_EQ(toy.configuration.velocity.threshold, 3.0);
  EXPECT_EQ(toy.configuration.velocity.iterations, 2);
  EXPECT_EQ(toy.configuration.depth.max_depth, 1.0);
  EXPECT_EQ(toy.configuration.velocity.side, Side::kRight);
  EXPECT_TRUE(toy.command_line.given("threshold"));
  EXPECT_TRUE(toy.command_line.given("max_depth"));
  EXPECT_TRUE(toy.command_line.given("max-depth"));
  EXPECT_FALSE(toy.command_line.given("azimuth_std"));
  EXPECT_TRUE(toy.command_line.givenMember(&toy.configuration.velocity.side));
  EXPECT_THROW(toy.command_line.given("side"), std::logic_error) << "no option of the tool";

  test::writeFile(second, "depth:\n  max_depth: 0\n");
  expectRefusal({"--config", second.c_str()},
                second + ":2: depth/max_depth is 0, must be between 1 and 10000 m");
}

TEST(CommandLine, ReadsEachOptionAndRefusesWhatIsNotValid) {
  const ToyConfiguration defaults;
  Toy toy;
  for (const Section& section : toy.configuration.sections()) {
    for (const Field& field : section.fields) {
      if (field.live_only || std::string(field.name) == "side") continue;
      std::string name = std::string("--") + field.name;
      std::replace(name.begin(), name.end(), '_', '-');
      const FieldValue value = test::anotherValue(field);
      ASSERT_NE(value, field.get()) << field.name;
      const std::string word = name + "=" + toText(value);
      EXPECT_EQ(toy.parse({word.c_str()}), std::nullopt);
      EXPECT_EQ(field.get(), value) << word;
      if (const std::optional<std::string> text = test::invalidText(field)) {
        const Refusal result = refusal(toy, {(name + "=" + *text).c_str()});
        EXPECT_EQ(result.exit_code, kUsageError) << name;
        EXPECT_EQ(result.text.rfind("evaluate_toy: " + name + " is ", 0), 0U) << result.text;
        EXPECT_EQ(field.get(), value) << field.name;
      }
    }
  }
}

TEST(CommandLine, RulesBetweenFieldsNameOptions) {
  const Toy toy;
  testing::internal::CaptureStderr();
  EXPECT_EQ(
      toy.command_line.refuse(InvalidParameter({"min_azimuth", "side"}, "min_azimuth (2 rad) and side")),
      kUsageError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "evaluate_toy: --min-azimuth (2 rad) and side (see --help)\n");
}

TEST(CommandLine, AReportRepeatsItsRun) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "report.json").string();
  Toy toy;
  for (const Section& section : toy.configuration.sections())
    for (const Field& field : section.fields) field.set(test::anotherValue(field));
  toy.configuration.velocity.side = Side::kLeft;    // no option
  toy.configuration.velocity.expected_rate = 13.0;  // without effect
  toy.configuration.velocity.threshold = 0.1 + 0.2;
  toy.configuration.velocity.farthest = std::numeric_limits<double>::infinity();
  toy.configuration.velocity.channels = {"a, b", "\"c\"\n"};
  toy.configuration.velocity.radars["front"].doppler_scale = -1.0 / 3.0;
  toy.configuration.velocity.radars["rear"] = {};
  toy.input.dataroot = "/data/nu scenes: 1";
  toy.input.scenes = {"scene-0061"};
  toy.output.json = "out.json";
  const std::string report =
      withParameters("{\n    \"scenes\": [1],\n    \"overall\": {}\n}\n", toy.command_line.parametersJson());
  test::writeFile(file, report);

  Toy again;
  EXPECT_EQ(again.parse({"--config", file.c_str()}), std::nullopt) << report;
  EXPECT_TRUE(sameFields(again.configuration.velocity, toy.configuration.velocity)) << report;
  EXPECT_TRUE(sameFields(again.configuration.depth, toy.configuration.depth)) << report;
  EXPECT_TRUE(sameFields(again.input, toy.input)) << report;
  EXPECT_EQ(again.output.json, "") << "a report does not bring back where it was written";
  EXPECT_EQ(again.command_line.parametersJson(), toy.command_line.parametersJson());
  EXPECT_TRUE(again.command_line.given("dataroot"));

  Toy other("evaluate_other");
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
  Toy toy;
  toy.command_line.require("dataroot");
  testing::internal::CaptureStdout();
  EXPECT_EQ(toy.parse({"--help", "--zzz"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_EQ(help, toy.command_line.help());
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
  const auto has = [&help](const std::string& part) {
    EXPECT_NE(help.find(part), std::string::npos) << part << "\n" << help;
  };
  has("Usage: evaluate_toy [--config FILE]... [OPTION]...\nScores toys.\n");
  has("\n  --dataroot TEXT               Folder of the data set [required]\n");
  has("\nEgo velocity / Estimate:\n");
  has("\n  --threshold NUMBER            Residual of a return that moves [between 0.001 and 100 m/s; "
      "default\n"
      "                                0.5]\n");
  has("1 sigma of a bearing [between 0 and 1 rad; default 0.01 (Ego\n"
      "                                velocity), 0.02 (Depth)]\n");
  has("\n  --solver NAME                 How the velocity is found [default ransac]\n"
      "                                  least_squares  All returns, as they are\n");
  has("\n  --[no-]neighbourhood          Let");
  has("\n  --refine                      Refine it\n");
  has("\n  --frame TEXT                  Frame of the result [default base_link]\n");
  has("\nExamples:\n  evaluate_toy --all\n");
}

}  // namespace
}  // namespace radar_dot::tools
