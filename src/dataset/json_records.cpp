// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "json_records.h"

#include <fmt/format.h>
#include <rapidjson/error/en.h>
#include <rapidjson/filereadstream.h>
#include <rapidjson/reader.h>

#include <cmath>
#include <cstdio>
#include <memory>

namespace radar_dot::dataset {
namespace {

constexpr std::size_t kReadBuffer = 1 << 16;
constexpr double kUnitTolerance = 1e-2;

constexpr std::string_view kKindNames[] = {"null",   "true or false", "a whole number", "a number",
                                           "a text", "a list",        "an object"};

}  // namespace

bool Record::has(std::size_t field) const noexcept {
  return starts_[field] != kMissing && nodes_[starts_[field]].kind != Kind::kNull;
}

void Record::clear() {
  starts_.assign(names_.size(), kMissing);
  nodes_.clear();
  texts_.clear();
}

void Record::fail(std::size_t field, std::string_view complaint) const {
  std::string identity;
  if (names_.front() == "token" && has(0) && nodes_[starts_[0]].kind == Kind::kText)
    identity = fmt::format(" (token {})", text(0));
  throw DatasetError(
      fmt::format("{} record {}{}: field '{}' {}", label_, number_, identity, names_[field], complaint));
}

JsonValue Record::value(std::size_t field) const {
  if (starts_[field] == kMissing) fail(field, "is missing");
  return {*this, starts_[field]};
}

const Record::Node& Record::require(std::size_t field, Kind kind, std::string_view kind_name) const {
  if (starts_[field] == kMissing) fail(field, "is missing");
  const Node& node = nodes_[starts_[field]];
  if (node.kind != kind)
    fail(field,
         fmt::format("must be {} but is {}", kind_name, kKindNames[static_cast<std::size_t>(node.kind)]));
  return node;
}

std::string_view Record::text(std::size_t field) const {
  const Node& node = require(field, Kind::kText, "a text");
  return std::string_view(texts_).substr(node.text_offset, node.size);
}

bool Record::boolean(std::size_t field) const {
  return require(field, Kind::kBoolean, "true or false").integer != 0;
}

double Record::number(std::size_t field) const {
  const JsonValue found = value(field);
  if (!found.isNumber()) require(field, Kind::kNumber, "a number");
  return found.number();
}

std::int64_t Record::integer(std::size_t field) const {
  return require(field, Kind::kInteger, "a whole number").integer;
}

std::int64_t Record::integer(std::size_t field, std::int64_t lowest, std::int64_t highest) const {
  const std::int64_t found = integer(field);
  if (found < lowest || found > highest)
    fail(field, fmt::format("must lie in {}..{} but is {}", lowest, highest, found));
  return found;
}

std::vector<JsonValue> Record::list(std::size_t field) const {
  require(field, Kind::kList, "a list");
  return value(field).items();
}

std::vector<std::string_view> Record::texts(std::size_t field) const {
  std::vector<std::string_view> found;
  for (const JsonValue& item : list(field)) {
    if (!item.isText()) fail(field, "must be a list of texts");
    found.push_back(item.text());
  }
  return found;
}

void Record::readNumbers(std::size_t field, double* values, std::size_t count) const {
  const Node* node = &require(field, Kind::kList, "a list of numbers");
  if (node->size != count) fail(field, fmt::format("must hold {} numbers", count));
  for (std::size_t i = 0; i < count; ++i) {
    ++node;
    if (node->kind == Kind::kNumber)
      values[i] = node->number;
    else if (node->kind == Kind::kInteger)
      values[i] = static_cast<double>(node->integer);
    else
      fail(field, fmt::format("must hold {} numbers but value {} is {}", count, i,
                              kKindNames[static_cast<std::size_t>(node->kind)]));
  }
}

std::array<double, 4> Record::quaternion(std::size_t field) const {
  const auto q = numbers<4>(field);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) < kUnitTolerance))
    fail(field, fmt::format("must be a unit quaternion w x y z but its norm is {:.6g}", norm));
  return q;
}

std::string_view JsonValue::text() const noexcept {
  return std::string_view(record_->texts_).substr(node().text_offset, node().size);
}

double JsonValue::number() const noexcept {
  return node().kind == Record::Kind::kInteger ? static_cast<double>(node().integer) : node().number;
}

std::size_t JsonValue::after() const noexcept {
  return node_ + 1 + (isList() || isObject() ? node().size : 0);
}

std::vector<JsonValue> JsonValue::items() const {
  std::vector<JsonValue> values;
  if (!isList()) return values;
  for (JsonValue item(*record_, node_ + 1); item.node_ < after(); item.node_ = item.after())
    values.push_back(item);
  return values;
}

bool JsonValue::member(std::string_view name, JsonValue& value) const {
  if (!isObject()) return false;
  for (JsonValue key(*record_, node_ + 1); key.node_ < after();) {
    const JsonValue content(*record_, key.after());
    if (key.text() == name) {
      value = content;
      return true;
    }
    key.node_ = content.after();
  }
  return false;
}

/// Takes RapidJSON's events and puts one record after the other together.
class RecordHandler {
 public:
  RecordHandler(Record& record, const std::function<void(const Record&)>& on_record)
      : record_(record), on_record_(on_record) {}

  bool Null() { return scalar(Record::Kind::kNull, 0); }
  bool Bool(bool value) { return scalar(Record::Kind::kBoolean, value ? 1 : 0); }
  bool Int(int value) { return scalar(Record::Kind::kInteger, value); }
  bool Uint(unsigned value) { return scalar(Record::Kind::kInteger, value); }
  bool Int64(std::int64_t value) { return scalar(Record::Kind::kInteger, value); }
  bool Uint64(std::uint64_t value) {
    if (value > INT64_MAX) return Double(static_cast<double>(value));
    return Int64(static_cast<std::int64_t>(value));
  }
  bool Double(double value) {
    Record::Node node;
    node.kind = Record::Kind::kNumber;
    node.number = value;
    return add(node);
  }
  bool RawNumber(const char*, rapidjson::SizeType, bool) { return false; }
  bool String(const char* text, rapidjson::SizeType length, bool) {
    if (!wanted()) return rejectOutside();
    Record::Node node;
    node.kind = Record::Kind::kText;
    node.size = length;
    node.text_offset = record_.texts_.size();
    record_.texts_.append(text, length);
    return add(node);
  }

  bool StartObject() {
    if (depth_ == kInList) {
      record_.clear();
      next_field_ = 0;
      ++depth_;
      return true;
    }
    return open(Record::Kind::kObject);
  }
  bool Key(const char* text, rapidjson::SizeType length, bool copy) {
    if (depth_ > kInRecord) return String(text, length, copy);
    const std::string_view key(text, length);
    // The records of a table name their fields in the same order, as a rule.
    const std::size_t count = record_.names_.size();
    for (std::size_t tried = 0; tried < count; ++tried, ++next_field_) {
      if (next_field_ >= count) next_field_ -= count;
      if (record_.names_[next_field_] != key) continue;
      record_.starts_[next_field_] = record_.nodes_.size();
      ++next_field_;
      wanted_ = true;
      return true;
    }
    wanted_ = false;
    return true;
  }
  bool EndObject(rapidjson::SizeType) {
    if (depth_ > kInRecord) return close();
    on_record_(record_);
    ++record_.number_;
    depth_ = kInList;
    return true;
  }
  bool StartArray() {
    if (depth_ == kOutside) {
      depth_ = kInList;
      return true;
    }
    return open(Record::Kind::kList);
  }
  bool EndArray(rapidjson::SizeType) {
    if (depth_ > kInRecord) return close();
    depth_ = kOutside;
    return true;
  }

 private:
  static constexpr int kOutside = 0;
  static constexpr int kInList = 1;
  static constexpr int kInRecord = 2;

  bool wanted() const noexcept { return wanted_ && depth_ >= kInRecord; }

  bool rejectOutside() const {
    if (depth_ >= kInRecord) return true;
    if (depth_ == kOutside) throw DatasetError(fmt::format("{}: must be a list of objects", record_.label_));
    throw DatasetError(fmt::format("{} record {}: must be an object", record_.label_, record_.number_));
  }

  bool scalar(Record::Kind kind, std::int64_t value) {
    Record::Node node;
    node.kind = kind;
    node.integer = value;
    return add(node);
  }
  bool add(const Record::Node& node) {
    if (!wanted()) return rejectOutside();
    record_.nodes_.push_back(node);
    return true;
  }
  bool open(Record::Kind kind) {
    rejectOutside();
    ++depth_;
    if (!wanted_) return true;
    open_.push_back(record_.nodes_.size());
    record_.nodes_.emplace_back().kind = kind;
    return true;
  }
  bool close() {
    --depth_;
    if (!wanted_) return true;
    record_.nodes_[open_.back()].size = static_cast<std::uint32_t>(record_.nodes_.size() - open_.back() - 1);
    open_.pop_back();
    return true;
  }

  Record& record_;
  const std::function<void(const Record&)>& on_record_;
  int depth_ = kOutside;
  bool wanted_ = false;            ///< the value being read belongs to a named field
  std::size_t next_field_ = 0;     ///< where to look for the next key first
  std::vector<std::size_t> open_;  ///< containers whose size is not known yet
};

void readRecords(const std::filesystem::path& file, const std::string& label, const Record::FieldNames& names,
                 const std::function<void(const Record&)>& on_record) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw DatasetError(fmt::format("{}: cannot open {}", label, file.string()));
  std::vector<char> buffer(kReadBuffer);
  rapidjson::FileReadStream input(stream.get(), buffer.data(), buffer.size());
  Record record(label, names);
  RecordHandler handler(record, on_record);
  rapidjson::Reader reader;
  const rapidjson::ParseResult result = reader.Parse(input, handler);
  if (result.IsError())
    throw DatasetError(
        fmt::format("{}: malformed JSON at byte {} ({}); is the file complete? Extract it again", label,
                    result.Offset(), rapidjson::GetParseError_En(result.Code())));
}

}  // namespace radar_dot::dataset
