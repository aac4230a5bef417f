// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "command_line.h"

namespace radar_dot::tools {
namespace {

constexpr std::size_t kWidth = 100;      // columns of the help
constexpr std::size_t kTextColumn = 32;  // where the sentences begin

/// Columns on a terminal: bytes that continue a character of UTF-8 take none.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// A text wrapped into the columns from `column` on; its first line begins there already.
std::string wrapped(const std::string& text, std::size_t column) {
  std::string lines;
  std::size_t at = column;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    const bool is_first = lines.empty();
    if (!is_first && at + 1 + widthOf(word) > kWidth) {
      lines += "\n" + std::string(column, ' ');
      at = column;
    } else if (!is_first) {
      lines += ' ';
      ++at;
    }
    lines += word;
    at += widthOf(word);
  }
  return lines + "\n";
}

/// An option beside, or where it is long above, its text.
std::string entry(const std::string& option, const std::string& text) {
  std::string line = "  " + option;
  if (line.size() + 2 > kTextColumn) line += "\n";
  const std::size_t used = line.back() == '\n' ? 0 : line.size();
  return line + std::string(kTextColumn - used, ' ') + wrapped(text, kTextColumn);
}

const char* placeholder(FieldType type) {
  switch (type) {
    case FieldType::kInt: return "INTEGER";
    case FieldType::kDouble: return "NUMBER";
    case FieldType::kEnum: return "NAME";
    case FieldType::kIntList:
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
  std::string lines;
  for (const auto& [name, meaning] : field.choices) {
    const std::string label = std::string(name) + std::string(widest + 2 - widthOf(name), ' ');
    lines += std::string(kTextColumn + 2, ' ') + label + wrapped(meaning, kTextColumn + 2 + label.size());
  }
  return lines;
}

void append(std::string& list, const std::string& item) {
  if (!item.empty()) list += (list.empty() ? "" : "; ") + item;
}

/// A flag that is off has none worth saying.
std::string defaultText(const Field& field) {
  const std::string text = toText(field.get());
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
    if (value.empty()) continue;
    defaults += (defaults.empty() ? "default " : ", ") + value;
    if (!is_same) defaults += " (" + option.headings[i] + ")";
  }
  append(details, defaults);

  std::string name = "--" + option.name;
  if (!option.isFlag())
    name += std::string(" ") + placeholder(field.type);
  else if (!defaults.empty())
    name = "--[no-]" + option.name;
  return entry(name, field.text + (details.empty() ? "" : " [" + details + "]")) +
         (has_meanings ? choices(field) : "");
}

std::string CommandLine::help() const {
  std::string text = "Usage: " + tool_ + (sections_.empty() ? "" : " [--config FILE]...") + " [OPTION]...\n";
  text += wrapped(purpose_, 0) + "\n";
  const bool has_flags =
      std::any_of(options_.begin(), options_.end(), [](const Option& option) { return option.isFlag(); });
  text += wrapped(std::string("Items of a list are joined by commas.") +
                      (has_flags ? " A flag --x is switched off by --no-x or --x=false." : ""),
                  0);
  text += "\n";
  if (!sections_.empty()) {
    text += entry("--config FILE",
                  "Parameters as roslaunch loads them (YAML), or a report of this tool (JSON), which repeats "
                  "its run. Several may be given: later files override earlier ones, options override files");
  }
  text += entry("--help", "Print this and exit");

  // Options under one heading stay together, whatever the order in which they were added.
  std::vector<std::pair<std::string, std::string>> blocks;
  for (const Option& option : options_) {
    const std::string group = option.field().group;
    const bool is_either = option.heading.empty() || group.empty() || group == option.heading;
    const std::string title =
        is_either ? (option.heading.empty() ? group : option.heading) : option.heading + " / " + group;
    const auto found = std::find_if(blocks.begin(), blocks.end(),
                                    [&title](const auto& known) { return known.first == title; });
    if (found == blocks.end())
      blocks.emplace_back(title, helpOf(option));
    else
      found->second += helpOf(option);
  }
  for (const auto& [title, block] : blocks) text += "\n" + title + ":\n" + block;
  if (!examples_.empty()) text += "\nExamples:\n";
  for (const std::string& example : examples_) text += "  " + example + "\n";
  return text;
}

}  // namespace radar_dot::tools
