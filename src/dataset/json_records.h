// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rapidjson/document.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

using JsonValue = rapidjson::Value;

inline std::string_view textOf(const JsonValue& text) { return {text.GetString(), text.GetStringLength()}; }

/// A field of the right kind whose value is none: null, not finite, no unit quaternion.
class ValueError : public DatasetError {
 public:
  using DatasetError::DatasetError;
};

/// One object of a JSON list, by the numbers of the fields asked for. Each of the readers throws
/// DatasetError where the field is missing or of another kind, ValueError where it is null or not finite.
class Record {
 public:
  using FieldNames = std::vector<std::string_view>;

  Record(const std::string& label, const FieldNames& names)
      : label_(label), values_(names.size()), names_(names) {}

  /// Position in the file's list, counted from 0.
  std::size_t number() const noexcept { return number_; }

  bool has(std::size_t field) const noexcept;  ///< present and not null
  const JsonValue& value(std::size_t field) const;
  std::string_view text(std::size_t field) const;
  bool boolean(std::size_t field) const;
  double number(std::size_t field) const;
  std::int64_t integer(std::size_t field) const;
  /// integer() with bounds, both included.
  std::int64_t integer(std::size_t field, std::int64_t lowest, std::int64_t highest) const;
  /// A list of any values.
  rapidjson::Value::ConstArray list(std::size_t field) const;
  std::vector<std::string_view> texts(std::size_t field) const;
  /// A list of exactly N numbers.
  template <std::size_t N>
  std::array<double, N> numbers(std::size_t field) const {
    std::array<double, N> values{};
    readNumbers(field, values.data(), N);
    return values;
  }
  /// w x y z. Fails where the norm is not 1.
  std::array<double, 4> quaternion(std::size_t field) const;

  /// @throws DatasetError "<file> record <number> (token ...): field '<name>' <complaint>".
  [[noreturn]] void fail(std::size_t field, std::string_view complaint) const {
    throw DatasetError(complaintOf(field, complaint));
  }
  /// The same for a value that stands for none.
  [[noreturn]] void failForValue(std::size_t field, std::string_view complaint) const {
    throw ValueError(complaintOf(field, complaint));
  }

 private:
  friend void readRecords(const std::filesystem::path&, const std::string&, const FieldNames&,
                          const std::function<void(const Record&)>&);

  void take(const JsonValue& object);
  std::string complaintOf(std::size_t field, std::string_view complaint) const;
  const JsonValue& require(bool (JsonValue::*is_kind)() const, std::size_t field,
                           std::string_view kind) const;
  void readNumbers(std::size_t field, double* values, std::size_t count) const;

  const std::string& label_;
  std::vector<const JsonValue*> values_;  ///< of the named fields; nullptr = missing
  const FieldNames& names_;
  std::size_t number_ = 0;
};

/// Reads a JSON file that is a list of objects and calls `on_record` for each, with the memory of its
/// longest record. `label` names the file in messages.
/// @throws DatasetError for a file that cannot be opened, malformed JSON (file and byte), content
///         that is no list of objects; whatever `on_record` throws passes through.
void readRecords(const std::filesystem::path& file, const std::string& label, const Record::FieldNames& names,
                 const std::function<void(const Record&)>& on_record);

}  // namespace radar_dot::dataset
