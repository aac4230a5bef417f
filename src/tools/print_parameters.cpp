// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "parameter_document.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/config/sections.h"

namespace {

struct Arguments {
  bool markdown = false;

  void describe(radar_dot::FieldList& fields) {
    fields.add("markdown", markdown, "Print tables for docs/parameters.md instead of a configuration file");
  }
};

}  // namespace

int main(int argc, char** argv) {
  namespace tools = radar_dot::tools;
  Arguments arguments;
  radar_dot::Configuration configuration;
  tools::CommandLine command_line("print_parameters",
                                  "Prints the parameters of all nodelets with their defaults.",
                                  {"print_parameters > vehicle.yaml", "print_parameters --markdown"});
  command_line.add("Options", radar_dot::fieldsOf(arguments));
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;

  const std::vector<radar_dot::Section> sections = sectionsOf(configuration);
  const std::string text =
      arguments.markdown ? tools::parametersMarkdown(sections) : tools::parametersYaml(sections);
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return 0;
  std::fputs("print_parameters: standard output cannot be written\n", stderr);
  return 1;
}
