// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/program_options.hpp>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/config/section.h"

namespace radar_dot::tools {

constexpr int kUsageError = 2;  ///< exit code
constexpr int kInPart = 3;      ///< exit code: done, but for what was left out

/// To be thrown at the end of work that was done but for something, which must have been listed.
struct DoneInPart : std::runtime_error {
  using runtime_error::runtime_error;
};

/// Which fields become options.
using FieldFilter = std::function<bool(const Field&)>;

/// The command line of a tool, an option per field: "--" + name with '-' for '_'. A flag takes --x, --no-x
/// and --x=true; everything else a value. Nothing is abbreviated and no option is given twice.
///
///     CommandLine command_line("evaluate_depth", "Scores depth maps against lidar points.",
///                              {"evaluate_depth --dataroot DIR"});
///     command_line.setSections(sectionsOf(configuration));
///     command_line.add("Input", fieldsOf(input));
///     command_line.add("Depth", fieldsOf(configuration.depth));
///     command_line.addOutputs("Output", fieldsOf(files));
///     command_line.require("dataroot");
///     if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
///
/// Defaults are the values the fields have when parse() is called. What the fields describe must outlive the
/// object.
class CommandLine {
 public:
  /// @param purpose   one sentence
  /// @param examples  command lines, at the end of the help
  CommandLine(std::string tool, std::string purpose, std::vector<std::string> examples);

  /// All sections of a configuration file, in use here or not, before what is added of them. With them the
  /// tool has --config.
  void setSections(std::vector<Section> sections);

  /// Options under a heading, and below it the groups of the fields, which are headings where it is empty.
  /// One for each field that the filter lets through and that has an effect without a live system.
  /// Fields of one name become one option that sets all of them; in the help it is where it was first added.
  /// @throws std::logic_error where their type, unit or range differ
  void add(const std::string& heading, const FieldList& fields, const FieldFilter& filter = {});
  /// The same for what belongs to one run alone, like files to write: parametersJson() leaves it out, so
  /// that no report brings back where it was written.
  void addOutputs(const std::string& heading, const FieldList& fields, const FieldFilter& filter = {});

  /// The words before the first option are the items of this list; `item` is what the usage calls one.
  void takeWords(const std::string& name, const std::string& item) {
    words_ = known(name).name;
    usage_ = " " + item + "...";
  }
  /// An option that must be given, with a text that is not empty, where the condition holds after reading
  /// all of them (empty: always). `alternative` is the option that takes its place, if there is one.
  void require(const std::string& name, const std::string& alternative = "",
               const std::function<bool()>& condition = {});
  /// Two options that do not go together; a flag that is off goes with everything.
  void exclude(const std::string& one, const std::string& other);
  /// The work may end with DoneInPart, for what is named in the help.
  void leavesOut(const std::string& what) { left_out_ = what; }

  /// Sets the fields: first from the files of --config in their order, then from the command line.
  /// @return the exit code where the tool is not to run: 0 after --help, kUsageError after a refusal, which
  ///         is then one line on standard error
  std::optional<int> parse(int argc, const char* const* argv);

  /// Was a field of this option set by a file or the command line? @throws std::logic_error where there is
  /// no such option
  bool given(const std::string& name) const;
  /// The same of one member of what the fields describe.
  bool givenMember(const void* member) const { return given_.count(member) > 0; }

  /// Runs the work of the tool. What goes wrong is one line on standard error.
  /// @param interrupted  what is left of the work after a signal
  /// @return the exit code
  int run(const std::string& interrupted, const std::function<void()>& work) const;
  /// Says on standard error what is wrong with how the tool was called: "tool: what (see --help)".
  /// @return kUsageError
  int refuse(const std::string& what) const;
  /// The same with options instead of the names of fields, and the places in files that set them.
  int refuse(const InvalidParameter& error) const;

  /// What is in force of what the tool offers, for withParameters(): {"tool": ..., "<section>": {...}, ...,
  /// "options": {...}}. --config reads the same values back.
  std::string parametersJson() const;

  std::string help() const;

 private:
  struct Option {
    std::string name;  ///< with '-'
    std::string heading;
    std::vector<Field> fields;
    std::vector<std::string> headings;  ///< of the fields
    const Field& field() const { return fields.front(); }
    bool isFlag() const { return field().type == FieldType::kBool; }
  };
  struct Requirement {
    std::string name, alternative;
    std::function<bool()> condition;
  };

  /// An option and the text of its value.
  using Setting = std::pair<const Option*, std::string>;

  FieldList offered(const std::string& heading, const FieldList& fields, const FieldFilter& filter);
  void addOption(const std::string& heading, const Field& field);
  const Option* find(const std::string& name) const;
  const Option& known(const std::string& name) const;
  /// The words for Boost: flags with their values.
  std::vector<std::string> wordsOf(int argc, const char* const* argv) const;
  std::vector<boost::program_options::option> optionsIn(const std::vector<std::string>& words) const;
  /// @param files  those of --config
  std::vector<Setting> settingsOf(const std::vector<boost::program_options::option>& parsed,
                                  std::vector<std::string>& files) const;
  std::string helpOf(const Option& option) const;
  void checkRules() const;
  /// Given, and no flag that is off or text that is empty.
  bool isOn(const std::string& name) const;
  /// Where files set fields of these names, in words; empty: nowhere.
  std::string placesOf(const std::vector<std::string>& names) const;
  std::string unknownOption(const std::string& name) const;
  int complain(const std::string& line) const;

  std::string tool_, purpose_, words_, usage_;  // words_: option of the leading words; usage_: these
  std::vector<std::string> examples_;
  std::vector<Section> sections_;
  std::vector<Option> options_;
  /// What is offered of each section, and at last of none, without outputs.
  std::vector<Section> offered_ = {{"options", "", {}}};
  std::string left_out_;  ///< what may be, in the help
  std::vector<Requirement> requirements_;
  std::vector<std::pair<std::string, std::string>> exclusions_;
  std::map<const void*, std::string> given_;  ///< by member: place in a file; empty: the command line
};

}  // namespace radar_dot::tools
