// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/fields.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numeric>

namespace radar_dot {
namespace {

// What every way of setting a parameter can carry.
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

std::string numberText(double number) {
  if (std::isinf(number)) return number < 0.0 ? "-inf" : "inf";
  const std::string text = fmt::format("{}", number);
  const std::size_t end = text.size();
  // Some versions of fmt write 1.0, others 1.
  return end > 2 && text.compare(end - 2, 2, ".0") == 0 ? text.substr(0, end - 2) : text;
}

std::string withUnit(const std::string& text, const Field& field) {
  return *field.unit == '\0' ? text : text + " " + field.unit;
}

[[noreturn]] void refuse(const Field& field, const std::string& value, const std::string& valid) {
  throw InvalidParameter({field.name}, fmt::format("{} is {}, must be {}", field.name, value, valid));
}

/// A real number that is whole, and that every way of setting a parameter can carry.
std::optional<std::int64_t> wholeNumber(double number) {
  if (std::trunc(number) != number || std::abs(number) > kMost) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

/// A value of another type that can stand for one of the field's type.
FieldValue converted(const Field& field, const FieldValue& value) {
  if (const auto* real = std::get_if<double>(&value); real != nullptr && field.type != FieldType::kDouble)
    if (const auto number = wholeNumber(*real)) return converted(field, *number);
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (whole != nullptr && field.type == FieldType::kDouble) return static_cast<double>(*whole);
  if (whole != nullptr && field.type == FieldType::kIntList)
    return std::vector<int>{static_cast<int>(*whole)};
  const auto* text = std::get_if<std::string>(&value);
  if (text != nullptr && field.type == FieldType::kTextList) return std::vector<std::string>{*text};
  return value;
}

bool hasType(const Field& field, const FieldValue& value) {
  // By FieldType: the alternatives of FieldValue.
  constexpr std::size_t kAlternatives[] = {1, 2, 3, 4, 4, 5, 6, 7};
  return value.index() == kAlternatives[static_cast<std::size_t>(field.type)] ||
         (field.optional && std::holds_alternative<std::monostate>(value));
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
}

std::vector<std::string> listItems(std::string text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '[' && text.back() == ']') text = text.substr(1, text.size() - 2);
  std::vector<std::string> items;
  if (trimmed(text).empty()) return items;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    items.push_back(trimmed(text.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return items;
}

std::optional<double> realNumber(const std::string& text) {
  // YAML writes infinity with a dot.
  if (text == ".inf" || text == "+.inf") return std::numeric_limits<double>::infinity();
  if (text == "-.inf") return -std::numeric_limits<double>::infinity();
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') return std::nullopt;
  return number;
}

/// Also 100.0 and 1e3.
std::optional<std::int64_t> wholeNumber(const std::string& text) {
  char* end = nullptr;
  errno = 0;
  const long long number = std::strtoll(text.c_str(), &end, 10);
  if (!text.empty() && *end == '\0') return errno == 0 ? std::optional<std::int64_t>(number) : std::nullopt;
  const std::optional<double> real = realNumber(text);
  return real ? wholeNumber(*real) : std::nullopt;
}

std::optional<bool> truth(const std::string& text) {
  std::string lower = text;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == "true" || lower == "yes" || lower == "on" || lower == "1") return true;
  if (lower == "false" || lower == "no" || lower == "off" || lower == "0") return false;
  return std::nullopt;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t swap = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, swap});
    }
  }
  return row.back();
}

struct ValueText {
  std::string operator()(std::monostate) const { return ""; }
  std::string operator()(bool is) const { return is ? "true" : "false"; }
  std::string operator()(std::int64_t number) const { return std::to_string(number); }
  std::string operator()(double number) const { return numberText(number); }
  std::string operator()(const std::string& text) const { return text; }
  template <typename Item>
  std::string operator()(const std::vector<Item>& list) const {
    return fmt::format("{}", fmt::join(list, ", "));
  }
  std::string operator()(const std::vector<double>& list) const {
    std::string text;
    for (const double number : list) text += (text.empty() ? "" : ", ") + numberText(number);
    return text;
  }
};

std::string valueText(const Field& field) { return withUnit(toText(field.get()), field); }

}  // namespace

std::string toText(const FieldValue& value) { return std::visit(ValueText(), value); }

const char* Field::typeText() const {
  constexpr const char* kTexts[] = {"true or false",   "a whole number",   "a number",
                                    "a text",          "a text",           "a list of whole numbers",
                                    "a list of texts", "a list of numbers"};
  return kTexts[static_cast<std::size_t>(type)];
}

std::string Field::valid() const {
  if (type == FieldType::kEnum) {
    std::string names;
    for (const auto& [choice, meaning] : choices) names += (names.empty() ? "" : ", ") + std::string(choice);
    return "one of " + names;
  }
  std::string count = length > 0 ? fmt::format("{} numbers", length) : "";
  const bool no_lowest = std::isinf(range.lowest) || range.lowest == -kMost;
  const bool no_highest = std::isinf(range.highest) || range.highest == kMost;
  if (no_lowest && no_highest) return count;
  const std::string gap = count.empty() ? "" : " ";
  if (no_highest) return count + gap + withUnit(numberText(range.lowest), *this) + " or more";
  if (no_lowest) return count + gap + withUnit(numberText(range.highest), *this) + " or less";
  return count + gap +
         withUnit(fmt::format("between {} and {}", numberText(range.lowest), numberText(range.highest)),
                  *this);
}

void Field::check(const FieldValue& given) const {
  const FieldValue value = converted(*this, given);
  const std::string given_text = type == FieldType::kEnum ? "'" + toText(value) + "'" : toText(value);
  if (!hasType(*this, value)) refuse(*this, "'" + toText(value) + "'", typeText());
  if (std::holds_alternative<std::monostate>(value)) return;
  const auto in_range = [this](double number) { return number >= range.lowest && number <= range.highest; };
  bool is_valid = true;  // a comparison with NaN is false
  if (const auto* number = std::get_if<double>(&value)) is_valid = in_range(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value))
    is_valid = in_range(static_cast<double>(*number));
  if (const auto* list = std::get_if<std::vector<int>>(&value))
    is_valid = std::all_of(list->begin(), list->end(), in_range);
  if (const auto* list = std::get_if<std::vector<double>>(&value))
    is_valid = list->size() == length && std::all_of(list->begin(), list->end(), in_range);
  if (type == FieldType::kEnum) {
    is_valid = std::any_of(choices.begin(), choices.end(), [&value](const auto& choice) {
      return std::get<std::string>(value) == choice.first;
    });
  }
  // valid() leaves out the end that stands for no limit.
  if (const auto* number = std::get_if<std::int64_t>(&value);
      number != nullptr && *number > kMost && range.highest >= kMost)
    refuse(*this, given_text, fmt::format("{} or less", kMost));
  if (!is_valid) refuse(*this, given_text, valid().empty() ? typeText() : valid());
}

void Field::set(const FieldValue& value) const {
  check(value);
  put(converted(*this, value));
}

void Field::setFromText(const std::string& given) const {
  const std::string text_given = trimmed(given);
  // Of texts and lists of any length, empty is a value.
  const bool has_empty =
      type == FieldType::kText || type == FieldType::kIntList || type == FieldType::kTextList;
  if (text_given.empty() && optional && !has_empty) return put({});
  switch (type) {
    case FieldType::kBool:
      if (const auto is = truth(text_given)) return set(*is);
      break;
    case FieldType::kInt:
      if (const auto number = wholeNumber(text_given)) return set(*number);
      break;
    case FieldType::kDouble:
      if (const auto number = realNumber(text_given)) return set(*number);
      break;
    case FieldType::kText: return set(given);
    case FieldType::kEnum: return set(text_given);
    case FieldType::kTextList: return set(listItems(given));
    case FieldType::kIntList: {
      std::vector<int> list;
      for (const std::string& item : listItems(given)) {
        const std::optional<std::int64_t> number = wholeNumber(item);
        if (!number || std::abs(*number) > kMost) refuse(*this, "'" + given + "'", typeText());
        list.push_back(static_cast<int>(*number));
      }
      return set(list);
    }
    case FieldType::kDoubleList: {
      std::vector<double> list;
      for (const std::string& item : listItems(given)) {
        const std::optional<double> number = realNumber(item);
        if (!number) refuse(*this, "'" + given + "'", typeText());
        list.push_back(*number);
      }
      return set(list);
    }
  }
  refuse(*this, "'" + given + "'", typeText());
}

void Field::setFromItems(const std::vector<std::string>& items) const {
  // Texts may hold commas, so they are not joined.
  if (type == FieldType::kIntList || type == FieldType::kDoubleList)
    return setFromText(fmt::format("[{}]", fmt::join(items, ", ")));
  set(items);
}

void FieldList::addOverrides(const FieldList& others, std::map<std::string, FieldValue>& values) {
  for (Field field : others) {
    field.group = group_;
    field.live_only = (flags_ & kLiveOnly) != 0;
    field.optional = field.overrides = true;
    field.address = nullptr;
    field.get = [&values, name = std::string(field.name)] {
      const auto found = values.find(name);
      return found == values.end() ? FieldValue() : found->second;
    };
    field.put = [&values, name = std::string(field.name)](const FieldValue& given) {
      if (std::holds_alternative<std::monostate>(given))
        values.erase(name);
      else
        values[name] = given;
    };
    fields_.push_back(std::move(field));
  }
}

void FieldList::append(const FieldList& other, const std::function<bool(const Field&)>& filter) {
  std::copy_if(other.begin(), other.end(), std::back_inserter(fields_),
               [&filter](const Field& field) { return !filter || filter(field); });
  dictionaries_.insert(dictionaries_.end(), other.dictionaries_.begin(), other.dictionaries_.end());
}

const Field* FieldList::find(std::string_view name) const {
  const auto found = std::find_if(begin(), end(), [name](const Field& field) { return name == field.name; });
  return found == end() ? nullptr : &*found;
}

const Field& FieldList::of(const void* member) const {
  const auto found =
      std::find_if(begin(), end(), [member](const Field& field) { return field.address == member; });
  if (found == end()) throw std::logic_error("a rule between parameters names a member that is not listed");
  return *found;
}

std::string nearestName(const std::string& unknown, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, unknown.size() / 3) + 1;
  for (const std::string& name : known) {
    // A part of a name is like it, above all its begin.
    const std::size_t begin = unknown.size() > 2 ? name.find(unknown) : std::string::npos;
    const std::size_t distance = begin == std::string::npos ? editDistance(unknown, name)
                                 : begin == 0               ? 1
                                                            : 2;
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

std::string FieldList::nearestName(const std::string& unknown) const {
  std::vector<std::string> known;
  for (const Field& field : fields_) known.emplace_back(field.name);
  for (const FieldDictionary& dictionary : dictionaries_) known.emplace_back(dictionary.name);
  return radar_dot::nearestName(unknown, known);
}

void checkFields(const FieldList& fields) {
  for (const Field& field : fields) field.check(field.get());
}

bool sameValues(const FieldList& a, const FieldList& b) {
  const auto same_entries = [](const FieldDictionary& x, const FieldDictionary& y) {
    const std::vector<std::string> keys = x.keys();
    return keys == y.keys() && std::all_of(keys.begin(), keys.end(), [&](const std::string& key) {
             return sameValues(x.entry(key), y.entry(key));
           });
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Field& x, const Field& y) { return x.get() == y.get(); }) &&
         std::equal(a.dictionaries().begin(), a.dictionaries().end(), b.dictionaries().begin(),
                    b.dictionaries().end(), same_entries);
}

void require(bool condition, const FieldList& fields, const std::vector<const void*>& members,
             const std::string& text) {
  if (condition) return;
  std::vector<std::string> names;
  std::string values;
  for (const void* member : members) {
    const Field& field = fields.of(member);
    names.emplace_back(field.name);
    values += fmt::format("{}{} is {}", values.empty() ? "" : " and ", field.name, valueText(field));
  }
  throw InvalidParameter(names, values + "; " + text);
}

static void requireOrder(bool condition, const FieldList& fields, const double& smaller, const double& larger,
                         const char* relation) {
  if (condition) return;
  const Field& low = fields.of(&smaller);
  const Field& high = fields.of(&larger);
  throw InvalidParameter(
      {low.name, high.name},
      fmt::format("{} ({}) must {} {} ({})", low.name, valueText(low), relation, high.name, valueText(high)));
}

void requireLess(const FieldList& fields, const double& smaller, const double& larger) {
  requireOrder(smaller < larger, fields, smaller, larger, "be smaller than");
}

void requireNotMore(const FieldList& fields, const double& smaller, const double& larger) {
  requireOrder(smaller <= larger, fields, smaller, larger, "not be larger than");
}

}  // namespace radar_dot
