// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

class JsonValue;

/// One object of a JSON list, reduced to the fields asked for. Values are laid out flat, each
/// container before its content, in buffers that live on from record to record: reading a table
/// needs the memory of its longest record.
class Record {
 public:
  using FieldNames = std::vector<std::string_view>;

  Record(std::string label, FieldNames names) : label_(std::move(label)), names_(std::move(names)) {}

  /// Position in the file's list, counted from 0.
  std::size_t number() const noexcept { return number_; }
  const std::string& label() const noexcept { return label_; }

  bool has(std::size_t field) const noexcept;  ///< present and not null
  /// Each of these throws DatasetError where the field is missing or of another kind.
  JsonValue value(std::size_t field) const;
  std::string_view text(std::size_t field) const;
  bool boolean(std::size_t field) const;
  double number(std::size_t field) const;
  std::int64_t integer(std::size_t field) const;
  /// integer() with bounds, both included.
  std::int64_t integer(std::size_t field, std::int64_t lowest, std::int64_t highest) const;
  /// A list of any values.
  std::vector<JsonValue> list(std::size_t field) const;
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
  [[noreturn]] void fail(std::size_t field, std::string_view complaint) const;

 private:
  friend class JsonValue;
  friend class RecordHandler;

  enum class Kind : std::uint8_t { kNull, kBoolean, kInteger, kNumber, kText, kList, kObject };
  struct Node {
    Kind kind = Kind::kNull;
    std::uint32_t size = 0;  ///< characters of a text, or nodes inside of a container
    union {
      std::int64_t integer = 0;
      double number;
      std::size_t text_offset;
    };
  };
  static constexpr std::size_t kMissing = static_cast<std::size_t>(-1);

  void clear();
  const Node& require(std::size_t field, Kind kind, std::string_view kind_name) const;
  void readNumbers(std::size_t field, double* values, std::size_t count) const;

  std::string label_;
  FieldNames names_;
  std::size_t number_ = 0;
  std::vector<std::size_t> starts_;  ///< node of each field, or kMissing
  std::vector<Node> nodes_;
  std::string texts_;
};

/// A value inside a record, for the fields that hold lists and objects.
class JsonValue {
 public:
  JsonValue(const Record& record, std::size_t node) : record_(&record), node_(node) {}

  bool isText() const noexcept { return node().kind == Record::Kind::kText; }
  bool isList() const noexcept { return node().kind == Record::Kind::kList; }
  bool isObject() const noexcept { return node().kind == Record::Kind::kObject; }
  bool isNumber() const noexcept {
    return node().kind == Record::Kind::kNumber || node().kind == Record::Kind::kInteger;
  }
  /// Callers ask for the kind first.
  std::string_view text() const noexcept;
  double number() const noexcept;
  /// Values of a list.
  std::vector<JsonValue> items() const;
  /// Member of an object, or this value itself where there is none.
  bool member(std::string_view name, JsonValue& value) const;

 private:
  const Record::Node& node() const noexcept { return record_->nodes_[node_]; }
  std::size_t after() const noexcept;  ///< node behind this value and its content
  const Record* record_;
  std::size_t node_;
};

/// Reads a JSON file that is a list of objects and calls `on_record` for each; fields that are not
/// named are skipped. `label` names the file in messages.
/// @throws DatasetError for a file that cannot be opened, malformed JSON (file and byte), content
///         that is no list of objects; whatever `on_record` throws passes through.
void readRecords(const std::filesystem::path& file, const std::string& label, const Record::FieldNames& names,
                 const std::function<void(const Record&)>& on_record);

}  // namespace radar_dot::dataset
