// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <regex>
#include <stdexcept>

#include "config/config_file.h"
#include "parameter_document.h"
#include "radar_dot/common/did_you_mean.h"
#include "signal_watch.h"
#include "text_layout.h"

namespace radar_dot::tools {
namespace {

namespace po = boost::program_options;

constexpr const char* kHelp = "help";
constexpr const char* kConfig = "config";
constexpr const char* kNo = "no-";

/// How the tool was called is wrong.
[[noreturn]] void fail(const std::string& what) { throw InvalidParameter({}, what); }

std::string optionName(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

bool isList(FieldType type) { return type == FieldType::kIntList || type == FieldType::kTextList; }

/// What was typed, in the words of Boost.
std::string usageOf(const po::invalid_command_line_syntax& error) {
  const std::string name = error.get_option_name();
  switch (error.kind()) {
    case po::invalid_syntax::extra_parameter: return name + " takes no value";
    case po::invalid_syntax::missing_parameter: return name + " needs a value";
    default: return name + " needs a value after '='";
  }
}

bool asksForHelp(const po::option& option) {
  return option.string_key == kHelp || (option.string_key.empty() && option.value.front() == "-h");
}

bool sameMeaning(const Field& a, const Field& b) {
  return a.type == b.type && std::string(a.unit) == b.unit && a.valid() == b.valid();
}

}  // namespace

CommandLine::CommandLine(std::string tool, std::string purpose, std::vector<std::string> examples)
    : tool_(std::move(tool)), purpose_(std::move(purpose)), examples_(std::move(examples)) {}

void CommandLine::setSections(std::vector<Section> sections) {
  sections_ = std::move(sections);
  for (const Section& section : sections_)
    offered_.insert(offered_.end() - 1, {section.name, section.nodelet, {}});
}

FieldList CommandLine::offered(const std::string& heading, const FieldList& fields,
                               const FieldFilter& filter) {
  FieldList list;
  list.append(fields,
              [&filter](const Field& field) { return !field.live_only && (!filter || filter(field)); });
  for (const Field& field : list) addOption(heading, field);
  return list;
}

void CommandLine::add(const std::string& heading, const FieldList& fields, const FieldFilter& filter) {
  const auto is_same = [&fields](const Section& section) {
    return std::any_of(section.fields.begin(), section.fields.end(), [&fields](const Field& field) {
      return fields.size() > 0 && field.address == fields.begin()->address;
    });
  };
  const auto place = std::find_if(sections_.begin(), sections_.end(), is_same) - sections_.begin();
  offered_[static_cast<std::size_t>(place)].fields.append(offered(heading, fields, filter));
}

void CommandLine::addOutputs(const std::string& heading, const FieldList& fields, const FieldFilter& filter) {
  offered(heading, fields, filter);
}

void CommandLine::addOption(const std::string& heading, const Field& field) {
  const std::string name = optionName(field.name);
  const Option* const found = find(name);
  if (found == nullptr) {
    const bool is_taken = name == kHelp || name == kConfig ||
                          std::any_of(options_.begin(), options_.end(), [&](const Option& option) {
                            return (option.isFlag() && name == kNo + option.name) ||
                                   (field.type == FieldType::kBool && option.name == kNo + name);
                          });
    if (is_taken) throw std::logic_error("--" + name + " has another meaning already");
    options_.push_back({name, heading, {field}, {heading}});
    return;
  }
  if (!sameMeaning(found->field(), field))
    throw std::logic_error(
        fmt::format("--{} of '{}' and of '{}' differ in type, unit or range", name, found->heading, heading));
  for (const Field& known : found->fields)
    if (known.address == field.address) return;
  Option& option = options_[static_cast<std::size_t>(found - options_.data())];
  option.fields.push_back(field);
  option.headings.push_back(heading);
}

void CommandLine::require(const std::string& name, const std::string& alternative,
                          const std::function<bool()>& condition) {
  requirements_.push_back(
      {known(name).name, alternative.empty() ? alternative : known(alternative).name, condition});
}

void CommandLine::exclude(const std::string& one, const std::string& other) {
  exclusions_.emplace_back(known(one).name, known(other).name);
}

const CommandLine::Option* CommandLine::find(const std::string& name) const {
  const auto found = std::find_if(options_.begin(), options_.end(),
                                  [&name](const Option& option) { return option.name == name; });
  return found == options_.end() ? nullptr : &*found;
}

const CommandLine::Option& CommandLine::known(const std::string& name) const {
  const Option* option = find(optionName(name));
  if (option == nullptr) throw std::logic_error(tool_ + " has no option --" + optionName(name));
  return *option;
}

std::string CommandLine::unknownOption(const std::string& name) const {
  std::vector<std::string> names = {kHelp};
  if (!sections_.empty()) names.emplace_back(kConfig);
  for (const Option& option : options_) {
    names.push_back(option.name);
    if (option.isFlag()) names.push_back(kNo + option.name);
  }
  const std::string nearest = nearestName(name, names);
  return "unknown option --" + name + didYouMean(nearest.empty() ? nearest : "--" + nearest);
}

std::vector<std::string> CommandLine::wordsOf(int argc, const char* const* argv) const {
  std::vector<std::string> words;
  int first = 1;
  std::string leading;
  for (; !words_.empty() && first < argc && std::strncmp(argv[first], "--", 2) != 0; ++first)
    append(leading, argv[first], ",");
  if (!leading.empty()) words = {"--" + words_, leading};
  for (int i = first; i < argc; ++i) {
    std::string word = argv[i];
    const bool is_option = word.rfind("--", 0) == 0;
    const std::size_t equals = word.find('=');
    const Option* option = is_option ? find(word.substr(2, std::min(equals, word.size()) - 2)) : nullptr;
    const Option* switched_off =
        is_option && word.rfind(kNo, 2) == 2 ? find(word.substr(2 + std::strlen(kNo))) : nullptr;
    if (option != nullptr && option->isFlag() && equals == std::string::npos) {
      word += "=true";
    } else if (option != nullptr && !option->isFlag() && equals == word.size() - 1) {
      // Boost refuses an empty value after '=', which clears a text or a list.
      words.push_back(word.substr(0, equals));
      word.clear();
    } else if (switched_off != nullptr && switched_off->isFlag()) {
      word = "--" + switched_off->name + "=false";
    }
    words.push_back(std::move(word));
  }
  return words;
}

std::vector<po::option> CommandLine::optionsIn(const std::vector<std::string>& words) const {
  po::options_description description;
  // They take ownership of the values.
  const auto declare = [&description](const std::string& name, const po::value_semantic* value) {
    description.add_options()(name.c_str(), value, "");
  };
  declare(kHelp, new po::untyped_value(true));
  if (!sections_.empty()) declare(kConfig, po::value<std::string>());
  for (const Option& option : options_) {
    declare(option.name, po::value<std::string>());
    if (option.isFlag()) declare(kNo + option.name, new po::untyped_value(true));
  }
  const auto style = po::command_line_style::allow_long | po::command_line_style::long_allow_adjacent |
                     po::command_line_style::long_allow_next;
  try {
    return po::command_line_parser(words)
        .options(description)
        .style(style)
        .allow_unregistered()
        .run()
        .options;
  } catch (const po::invalid_command_line_syntax& error) {
    fail(usageOf(error));
  }
}

std::vector<CommandLine::Setting> CommandLine::settingsOf(const std::vector<po::option>& parsed,
                                                          std::vector<std::string>& files) const {
  std::vector<Setting> settings;
  const Option* previous = nullptr;
  for (const po::option& each : parsed) {
    const std::string& name = each.string_key;
    const std::string value = each.value.empty() ? "" : each.value.front();
    if (name.empty()) {
      const bool is_list = previous != nullptr && isList(previous->field().type);
      fail(fmt::format("'{}' belongs to no option{}", value,
                       is_list ? "; the items of a list are joined by commas" : ""));
    }
    if (each.unregistered) fail(unknownOption(name));
    // The next option, whether Boost knows it or not.
    if (each.original_tokens.size() > 1 && value.rfind("--", 0) == 0)
      fail(fmt::format("--{} needs a value", name));
    previous = find(name);
    if (name == kConfig) {
      files.push_back(value);
      continue;
    }
    for (const Setting& setting : settings)
      if (setting.first == previous) fail(fmt::format("--{} is given twice", name));
    settings.emplace_back(previous, value);
  }
  return settings;
}

bool CommandLine::isOn(const std::string& name) const {
  if (!given(name)) return false;
  const std::string text = toText(known(name).field().get());
  return !text.empty() && !(known(name).isFlag() && text == "false");
}

void CommandLine::checkRules() const {
  for (const auto& [one, other] : exclusions_)
    if (isOn(one) && isOn(other)) fail(fmt::format("--{} excludes --{}", one, other));
  for (const Requirement& each : requirements_) {
    if (isOn(each.name) || (each.condition && !each.condition())) continue;
    fail(fmt::format("--{}{}{} must be given: {}", each.name, each.alternative.empty() ? "" : " or --",
                     each.alternative, known(each.name).field().text));
  }
}

std::optional<int> CommandLine::parse(int argc, const char* const* argv) {
  try {
    const std::vector<po::option> parsed = optionsIn(wordsOf(argc, argv));
    // Who asks for help gets it, whatever else is wrong.
    if (std::any_of(parsed.begin(), parsed.end(), asksForHelp)) {
      std::fputs(help().c_str(), stdout);
      return 0;
    }
    std::vector<std::string> files;
    const std::vector<Setting> settings = settingsOf(parsed, files);
    for (const std::string& file : files)
      for (const auto& [member, place] : readConfigFile(file, sections_, tool_, offered_.back().fields))
        given_[member] = place;
    for (const auto& [option, text] : settings) {
      for (const Field& field : option->fields) {
        given_[field.address].clear();
        field.setFromText(text);
      }
    }
    checkRules();
  } catch (const InvalidParameter& error) {
    return refuse(error);
  } catch (const ConfigFileError& error) {
    return complain(error.what());
  }
  return std::nullopt;
}

bool CommandLine::given(const std::string& name) const {
  const std::vector<Field>& fields = known(name).fields;
  return std::any_of(fields.begin(), fields.end(),
                     [this](const Field& field) { return givenMember(field.address); });
}

int CommandLine::complain(const std::string& line) const {
  std::string text = tool_ + ": " + line;
  // One line, whatever was typed.
  for (char& c : text)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = '?';
  std::fputs((text + "\n").c_str(), stderr);
  return kUsageError;
}

int CommandLine::run(const std::string& interrupted, const std::function<void()>& work) const {
  try {
    work();
    return EXIT_SUCCESS;
  } catch (const InvalidParameter& error) {
    return refuse(error);
  } catch (const Interrupted& interrupt) {
    fmt::print(stderr, "{}: interrupted; {}\n", tool_, interrupted);
    return kSignalBase + interrupt.signal;
  } catch (const DoneInPart& part) {
    fmt::print(stderr, "{}: {}\n", tool_, part.what());
    return kInPart;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", tool_, error.what());
    return EXIT_FAILURE;
  }
}

int CommandLine::refuse(const std::string& what) const { return complain(what + " (see --help)"); }

int CommandLine::refuse(const InvalidParameter& error) const {
  std::string text = error.what();
  for (const std::string& name : error.names()) {
    if (find(optionName(name)) == nullptr) continue;
    const std::regex word("(^|[^\\w-])" + name + "(?![\\w-])");
    text = std::regex_replace(text, word, "$1--" + optionName(name), std::regex_constants::format_first_only);
  }
  return refuse(text + placesOf(error.names()));
}

std::string CommandLine::placesOf(const std::vector<std::string>& names) const {
  std::string places;
  const auto add = [&](const FieldList& fields) {
    for (const Field& field : fields) {
      const auto found = given_.find(field.address);
      if (found == given_.end() || std::find(names.begin(), names.end(), field.name) == names.end()) continue;
      append(places, found->second, " and ");
    }
  };
  for (const Section& section : sections_) add(section.fields);
  add(offered_.back().fields);
  return places.empty() ? places : "; set in " + places;
}

std::string CommandLine::parametersJson() const { return tools::parametersJson(tool_, offered_); }

}  // namespace radar_dot::tools
