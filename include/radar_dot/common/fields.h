// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "radar_dot/common/enum_names.h"

// The one declaration of a parameter. A struct of parameters lists its members once:
//
//     struct SweepParams {
//       double window = 0.1;
//       void describe(FieldList& fields) {
//         fields.add("window", window, "Age of the oldest scan of a sweep relative to its newest", "s",
//         {0.001, 10.0});
//       }
//     };
//
// The default is the member's initialiser and the range is the range of validity. Validation, command-line
// options, YAML, JSON, dynamic_reconfigure, documentation and comparison are all derived from the list.

namespace radar_dot {

/// A parameter, or several that do not go together, refused. what() names them, and what is valid.
class InvalidParameter : public std::invalid_argument {
 public:
  InvalidParameter(std::vector<std::string> names, const std::string& what)
      : std::invalid_argument(what), names_(std::move(names)) {}
  const std::vector<std::string>& names() const noexcept { return names_; }

 private:
  std::vector<std::string> names_;
};

/// Valid numbers, both ends included.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

enum class FieldType { kBool, kInt, kDouble, kText, kEnum, kIntList, kTextList, kDoubleList };

/// The value of a field, by its type: an enum as its name, an optional value that is not set as monostate.
using FieldValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<int>,
                                std::vector<std::string>, std::vector<double>>;

/// As in a configuration file: "0.5", "true", "0, 4". Numbers are read back exactly.
std::string toText(const FieldValue& value);

/// The known name most like an unknown one, for messages; empty: none is like it.
std::string nearestName(const std::string& unknown, const std::vector<std::string>& known);

/// One parameter of one object, which must outlive it.
struct Field {
  const char* name = "";  ///< ROS parameter, YAML and JSON key; the option is "--" + name with '-' for '_'
  const char* unit = "";
  const char* text = "";   ///< one sentence
  const char* group = "";  ///< heading under which it is listed
  FieldType type = FieldType::kText;
  Range range;
  std::size_t length = 0;  ///< of a list of numbers; 0: any
  bool at_start = false;   ///< read once: not to be changed while the nodelet runs
  bool live_only = false;  ///< without effect on evaluation, which reads files instead of topics
  bool optional = false;   ///< may have no value: monostate, or an empty text
  bool overrides =
      false;  ///< takes the place of a parameter of the same name elsewhere, where it has a value
  std::vector<std::pair<const char*, const char*>> choices;  ///< of an enum: name, text

  const void* address = nullptr;  ///< of the member
  std::function<FieldValue()> get;
  std::function<void(const FieldValue&)> put;  ///< without a check

  /// "between 0 and 1 m", "one of a, b": what is valid; empty: everything of its type.
  std::string valid() const;
  /// "a whole number", "a list of texts"
  const char* typeText() const;
  /// @throws InvalidParameter naming field, value and what is valid, also for another type
  void check(const FieldValue& given) const;
  /// Checked. An integer is accepted for a real number, and 5.0 for an integer.
  void set(const FieldValue& value) const;
  /// From text as in toText, also 5.0 for an integer, and yes, on, 1 for true; lists with or without
  /// brackets. @throws InvalidParameter
  void setFromText(const std::string& given) const;
  /// A list, from the texts of its items. @throws InvalidParameter
  void setFromItems(const std::vector<std::string>& items) const;
};

class FieldList;

/// Parameters of named things: name -> parameters of each.
struct FieldDictionary {
  const char* name = "";
  const char* text = "";
  std::function<FieldList(const std::string& key)> entry;  ///< made where it does not exist
  std::function<std::vector<std::string>()> keys;
  std::function<void(const std::string& key)> erase;
};

/// The parameters of an object, in the order in which they are shown.
class FieldList {
 public:
  enum Flags : unsigned { kNone = 0, kAtStart = 1, kLiveOnly = 2 };

  /// Heading and flags of the fields that follow.
  void group(const char* name, unsigned flags = kNone) {
    group_ = name;
    flags_ = flags;
  }

  template <typename Value>
  void add(const char* name, Value& value, const char* text, const char* unit = "", Range range = {});

  template <typename Entry>
  void addDictionary(const char* name, std::map<std::string, Entry>& entries, const char* text);

  /// Each field of another list as an optional one, whose value is kept by its name in `values`.
  void addOverrides(const FieldList& others, std::map<std::string, FieldValue>& values);

  /// The fields of another list that the filter lets through, and its dictionaries.
  void append(const FieldList& other, const std::function<bool(const Field&)>& filter = {});

  using value_type = Field;
  std::vector<Field>::const_iterator begin() const { return fields_.begin(); }
  std::vector<Field>::const_iterator end() const { return fields_.end(); }
  std::size_t size() const { return fields_.size(); }
  const std::vector<FieldDictionary>& dictionaries() const { return dictionaries_; }

  /// Null where there is none.
  const Field* find(std::string_view name) const;
  /// The field that stands for a member. @throws std::logic_error where it is not listed
  const Field& of(const void* member) const;
  /// Of these fields and dictionaries.
  std::string nearestName(const std::string& unknown) const;

 private:
  std::vector<Field> fields_;
  std::vector<FieldDictionary> dictionaries_;
  const char* group_ = "";
  unsigned flags_ = kNone;
};

template <typename Params>
FieldList fieldsOf(Params& params) {
  FieldList fields;
  // Describing does not change an object; who holds a const one must not set its fields.
  const_cast<std::remove_const_t<Params>&>(params).describe(fields);
  return fields;
}

/// @throws InvalidParameter for the first field outside its range
void checkFields(const FieldList& fields);
template <typename Params>
void validateFields(const Params& params) {
  checkFields(fieldsOf(params));
}

/// Of parameters without rules between fields; those with rules have an overload beside their struct.
template <typename Params, typename = decltype(&Params::describe)>
void validate(const Params& params) {
  validateFields(params);
}

bool sameValues(const FieldList& a, const FieldList& b);
/// Are all parameters equal?
template <typename Params>
bool sameFields(const Params& a, const Params& b) {
  return sameValues(fieldsOf(a), fieldsOf(b));
}

/// Rules between fields, which name them by the members of an object in `fields`.
/// @throws InvalidParameter "min_range (5 m) must be smaller than max_range (2 m)"
void requireLess(const FieldList& fields, const double& smaller, const double& larger);
void requireNotMore(const FieldList& fields, const double& smaller, const double& larger);
/// @throws InvalidParameter of these members with the text
void require(bool condition, const FieldList& fields, const std::vector<const void*>& members,
             const std::string& text);

namespace detail {

template <typename Value>
struct OptionalValue : std::false_type {};
template <typename Value>
struct OptionalValue<std::optional<Value>> : std::true_type {};

/// Numbers of a fixed count; 0: no array.
template <typename Value>
constexpr std::size_t kLength = 0;
template <std::size_t length>
constexpr std::size_t kLength<std::array<double, length>> = length;

template <typename Value>
FieldValue toFieldValue(const Value& value) {
  if constexpr (std::is_enum_v<Value>)
    return std::string(toString(value));
  else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>)
    return static_cast<std::int64_t>(value);
  else if constexpr (kLength<Value> > 0)
    return std::vector<double>(value.begin(), value.end());
  else
    return value;
}

template <typename Value>
Value fromFieldValue(const FieldValue& given) {
  if constexpr (std::is_enum_v<Value>) {
    return fromString<Value>(std::get<std::string>(given));
  } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
    return static_cast<Value>(std::get<std::int64_t>(given));
  } else if constexpr (kLength<Value> > 0) {
    Value value{};
    std::copy_n(std::get<std::vector<double>>(given).begin(), kLength<Value>, value.begin());
    return value;
  } else {
    return std::get<Value>(given);
  }
}

/// Type, choices and the range of what the type can hold.
template <typename Value>
void setType(Field& field) {
  if constexpr (std::is_enum_v<Value>) {
    field.type = FieldType::kEnum;
    for (const EnumName<Value>& each : EnumNames<Value>::kValues)
      field.choices.emplace_back(each.name, each.text);
  } else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
    field.type = FieldType::kInt;
    // What every way of setting a parameter can carry.
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    field.range.lowest = std::max(field.range.lowest, std::is_unsigned_v<Value> ? 0.0 : -kMost);
    field.range.highest = std::min(field.range.highest, kMost);
  } else if constexpr (kLength<Value> > 0) {
    field.type = FieldType::kDoubleList;
    field.length = kLength<Value>;
  } else {
    constexpr bool kFlag = std::is_same_v<Value, bool>;
    constexpr bool kReal = std::is_same_v<Value, double>;
    constexpr bool kInts = std::is_same_v<Value, std::vector<int>>;
    constexpr bool kText = std::is_same_v<Value, std::string>;
    static_assert(kFlag || kReal || kInts || kText || std::is_same_v<Value, std::vector<std::string>>);
    field.type = kFlag   ? FieldType::kBool
                 : kReal ? FieldType::kDouble
                 : kInts ? FieldType::kIntList
                 : kText ? FieldType::kText
                         : FieldType::kTextList;
  }
}

}  // namespace detail

template <typename Value>
void FieldList::add(const char* name, Value& value, const char* text, const char* unit, Range range) {
  Field field;
  field.name = name;
  field.unit = unit;
  field.text = text;
  field.group = group_;
  field.range = range;
  field.at_start = (flags_ & kAtStart) != 0;
  field.live_only = (flags_ & kLiveOnly) != 0;
  field.address = &value;
  if constexpr (detail::OptionalValue<Value>::value) {
    using Inner = typename Value::value_type;
    detail::setType<Inner>(field);
    field.optional = true;
    field.get = [&value] { return value ? detail::toFieldValue(*value) : FieldValue(); };
    field.put = [&value](const FieldValue& given) {
      value.reset();
      if (!std::holds_alternative<std::monostate>(given)) value = detail::fromFieldValue<Inner>(given);
    };
  } else {
    detail::setType<Value>(field);
    field.get = [&value] { return detail::toFieldValue(value); };
    field.put = [&value](const FieldValue& given) { value = detail::fromFieldValue<Value>(given); };
  }
  fields_.push_back(std::move(field));
}

template <typename Entry>
void FieldList::addDictionary(const char* name, std::map<std::string, Entry>& entries, const char* text) {
  FieldDictionary dictionary;
  dictionary.name = name;
  dictionary.text = text;
  dictionary.entry = [&entries](const std::string& key) { return fieldsOf(entries[key]); };
  dictionary.keys = [&entries] {
    std::vector<std::string> keys;
    for (const auto& [key, entry] : entries) keys.push_back(key);
    return keys;
  };
  dictionary.erase = [&entries](const std::string& key) { entries.erase(key); };
  dictionaries_.push_back(std::move(dictionary));
}

}  // namespace radar_dot
