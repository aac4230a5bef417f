// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "command_line.h"
#include "text_layout.h"

namespace radar_dot::tools {
namespace {

constexpr std::size_t kWidth = 100;      // columns of the help
constexpr std::size_t kTextColumn = 32;  // where the sentences begin

/// An option beside, or where it is long above, its text.
std::string entry(const std::string& option, const std::string& text) {
  std::string line = "  " + option;
  if (line.size() + 2 > kTextColumn) line += "\n";
  const std::size_t used = line.back() == '\n' ? 0 : line.size();
  const std::string indent(kTextColumn, ' ');
  return wrapped(line + indent.substr(used), text, indent, kWidth);
}

const char* placeholder(FieldType type) {
  switch (type) {
    case FieldType::kInt: return "INTEGER";
    case FieldType::kDouble: return "NUMBER";
    case FieldType::kEnum: return "NAME";
    case FieldType::kIntList:
    case FieldType::kDoubleList:
    case FieldType::kTextList: return "LIST";
    case FieldType::kBool:
    case FieldType::kText: break;
  }
  return "TEXT";
}

bool hasMeanings(const Field& field) {
  return std::any_of(field.choices.begin(), field.choices.end(),
                     [](const auto& choice) { return *choice.second != '\0'; });
}

std::string choices(const Field& field) {
  std::size_t widest = 0;
  for (const auto& [name, meaning] : field.choices) widest = std::max(widest, widthOf(name));
  const std::string indent(kTextColumn + 2 + widest + 2, ' ');
  std::string lines;
  for (const auto& [name, meaning] : field.choices) {
    const std::string label = std::string(kTextColumn + 2, ' ') + name;
    lines += wrapped(label + indent.substr(widthOf(label)), meaning, indent, kWidth);
  }
  return lines;
}

/// A flag that is off has none worth saying.
std::string defaultText(const Field& field) {
  std::string text = toText(field.get());
  if (field.type == FieldType::kBool) return text == "true" ? "on" : "";
  return text;
}

}  // namespace

std::string CommandLine::helpOf(const Option& option) const {
  const Field& field = option.field();
  const bool has_meanings = hasMeanings(field);
  std::string details;
  for (const Requirement& requirement : requirements_) {
    if (requirement.name != option.name) continue;
    if (!requirement.alternative.empty())
      append(details, "required without --" + requirement.alternative);
    else if (!requirement.condition)
      append(details, "required");
  }
  if (!has_meanings) append(details, field.valid().empty() ? field.unit : field.valid());

  // One option may stand for fields of several parts, with defaults of their own.
  const bool is_same = std::all_of(option.fields.begin(), option.fields.end(),
                                   [&field](const Field& other) { return other.get() == field.get(); });
  std::string defaults;
  for (std::size_t i = 0; i < (is_same ? 1 : option.fields.size()); ++i) {
    const std::string value = defaultText(option.fields[i]);
    append(defaults, is_same || value.empty() ? value : value + " (" + option.headings[i] + ")", ", ");
  }
  if (!defaults.empty()) append(details, "default " + defaults);

  std::string name = "--" + option.name;
  if (!option.isFlag())
    name += std::string(" ") + placeholder(field.type);
  else if (!defaults.empty())
    name = "--[no-]" + option.name;
  return entry(name, field.text + (details.empty() ? "" : " [" + details + "]")) +
         (has_meanings ? choices(field) : "");
}

std::string CommandLine::help() const {
  std::string text =
      "Usage: " + tool_ + usage_ + (sections_.empty() ? "" : " [--config FILE]...") + " [OPTION]...\n";
  text += wrapped("", purpose_, "", kWidth) + "\n";
  const bool has_flags =
      std::any_of(options_.begin(), options_.end(), [](const Option& option) { return option.isFlag(); });
  text += wrapped("",
                  std::string("Items of a list are joined by commas.") +
                      (has_flags ? " A flag --x is switched off by --no-x or --x=false." : ""),
                  "", kWidth);
  text += "\n";
  if (!sections_.empty()) {
    text += entry("--config FILE",
                  "Parameters as roslaunch loads them (YAML), or a report of this tool (JSON), which repeats "
                  "its run. Several may be given: later files override earlier ones, options override files");
  }
  text += entry("--help", "Print this and exit");

  // Options under one heading stay together, whatever the order in which they were added.
  const auto title_of = [](const Option& option) {
    const std::string group = option.field().group == option.heading ? "" : option.field().group;
    const bool is_either = option.heading.empty() || group.empty();
    return option.heading + (is_either ? "" : " / ") + group;
  };
  for (const auto& [title, options] : grouped(options_, title_of)) {
    text += "\n" + title + ":\n";
    for (const Option* option : options) text += helpOf(*option);
  }
  if (!left_out_.empty()) {
    text += "\n" + wrapped("",
                           fmt::format("Exit code: 0 done; 1 failed; {} wrong usage; {} done but for {}, "
                                       "which is left out and listed with the reasons.",
                                       kUsageError, kInPart, left_out_),
                           "", kWidth);
  }
  if (!examples_.empty()) text += "\nExamples:\n";
  for (const std::string& example : examples_) text += "  " + example + "\n";
  return text;
}

}  // namespace radar_dot::tools
