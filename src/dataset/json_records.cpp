// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "json_records.h"

#include <fmt/format.h>
#include <rapidjson/error/en.h>
#include <rapidjson/filereadstream.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace radar_dot::dataset {
namespace {

constexpr std::size_t kReadBuffer = 1 << 16;
constexpr double kUnitTolerance = 1e-2;

std::string_view kindOf(const JsonValue& value) {
  constexpr std::string_view kKinds[] = {"null",   "true or false", "true or false", "an object",
                                         "a list", "a text",        "a number"};  // by rapidjson::Type
  return value.IsInt64() ? "a whole number" : kKinds[value.GetType()];
}

}  // namespace

void Record::take(const JsonValue& object) {
  std::fill(values_.begin(), values_.end(), nullptr);
  // The records of a table name their fields in the same order, as a rule.
  std::size_t next = 0;
  for (const auto& member : object.GetObject()) {
    const std::string_view name = textOf(member.name);
    for (std::size_t tried = 0; tried < names_.size(); ++tried, ++next) {
      if (next == names_.size()) next = 0;
      if (names_[next] != name) continue;
      values_[next++] = &member.value;
      break;
    }
  }
}

bool Record::has(std::size_t field) const noexcept {
  return values_[field] != nullptr && !values_[field]->IsNull();
}

std::string Record::complaintOf(std::size_t field, std::string_view complaint) const {
  std::string identity;
  if (names_.front() == "token" && has(0) && values_[0]->IsString())
    identity = fmt::format(" (token {})", text(0));
  return fmt::format("{} record {}{}: field '{}' {}", label_, number_, identity, names_[field], complaint);
}

const JsonValue& Record::value(std::size_t field) const {
  if (values_[field] == nullptr) fail(field, "is missing");
  return *values_[field];
}

const JsonValue& Record::require(bool (JsonValue::*is_kind)() const, std::size_t field,
                                 std::string_view kind) const {
  const JsonValue& found = value(field);
  if ((found.*is_kind)()) return found;
  const std::string complaint = fmt::format("must be {} but is {}", kind, kindOf(found));
  if (found.IsNull()) failForValue(field, complaint);
  fail(field, complaint);
}

std::string_view Record::text(std::size_t field) const {
  return textOf(require(&JsonValue::IsString, field, "a text"));
}

bool Record::boolean(std::size_t field) const {
  return require(&JsonValue::IsBool, field, "true or false").GetBool();
}

double Record::number(std::size_t field) const {
  const double found = require(&JsonValue::IsNumber, field, "a number").GetDouble();
  if (!std::isfinite(found)) failForValue(field, fmt::format("must be finite but is {}", found));
  return found;
}

std::int64_t Record::integer(std::size_t field) const {
  return require(&JsonValue::IsInt64, field, "a whole number").GetInt64();
}

std::int64_t Record::integer(std::size_t field, std::int64_t lowest, std::int64_t highest) const {
  const std::int64_t found = integer(field);
  if (found < lowest || found > highest)
    fail(field, fmt::format("must lie in {}..{} but is {}", lowest, highest, found));
  return found;
}

JsonValue::ConstArray Record::list(std::size_t field) const {
  return require(&JsonValue::IsArray, field, "a list").GetArray();
}

std::vector<std::string_view> Record::texts(std::size_t field) const {
  std::vector<std::string_view> found;
  for (const JsonValue& item : list(field)) {
    if (!item.IsString()) fail(field, "must be a list of texts");
    found.push_back(textOf(item));
  }
  return found;
}

void Record::readNumbers(std::size_t field, double* values, std::size_t count) const {
  const JsonValue& found = require(&JsonValue::IsArray, field, "a list of numbers");
  if (found.Size() != count) fail(field, fmt::format("must hold {} numbers", count));
  for (rapidjson::SizeType i = 0; i < count; ++i) {
    if (!found[i].IsNumber()) {
      const std::string complaint =
          fmt::format("must hold {} numbers but value {} is {}", count, i, kindOf(found[i]));
      if (found[i].IsNull()) failForValue(field, complaint);
      fail(field, complaint);
    }
    values[i] = found[i].GetDouble();
    if (!std::isfinite(values[i]))
      failForValue(field, fmt::format("must hold finite numbers but value {} is {}", i, values[i]));
  }
}

std::array<double, 4> Record::quaternion(std::size_t field) const {
  const auto q = numbers<4>(field);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) < kUnitTolerance))
    failForValue(field, fmt::format("must be a unit quaternion w x y z but its norm is {:.6g}", norm));
  return q;
}

void readRecords(const std::filesystem::path& file, const std::string& label, const Record::FieldNames& names,
                 const std::function<void(const Record&)>& on_record) {
  using namespace rapidjson;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw DatasetError(fmt::format("{}: cannot open {}", label, file.string()));
  std::vector<char> buffer(kReadBuffer), memory(kReadBuffer);
  FileReadStream input(stream.get(), buffer.data(), buffer.size());
  MemoryPoolAllocator<> pool(memory.data(), memory.size());
  const auto fail = [&](ParseErrorCode error, std::size_t byte) {
    throw DatasetError(
        fmt::format("{}: malformed JSON at byte {} ({}); is the file complete? Extract it again", label, byte,
                    GetParseError_En(error)));
  };
  const auto skipTo = [&input](char wanted) {
    SkipWhitespace(input);
    if (input.Peek() != wanted) return false;
    input.Take();
    return true;
  };
  if (!skipTo('[')) {
    if (input.Peek() == '\0') fail(kParseErrorDocumentEmpty, input.Tell());
    if (std::string_view("{\"-0123456789tfn").find(input.Peek()) == std::string_view::npos)
      fail(kParseErrorValueInvalid, input.Tell());
    throw DatasetError(fmt::format("{}: must be a list of objects", label));
  }
  Reader reader;
  const auto parse = [&](Document& object) {
    // Python writes NaN and Infinity; the readers of numbers refuse them by name.
    return !reader.Parse<kParseStopWhenDoneFlag | kParseNanAndInfFlag>(input, object).IsError();
  };
  Record record(label, names);
  for (bool is_over = skipTo(']'); !is_over; ++record.number_) {
    Document object(&pool);
    object.Populate(parse);
    if (reader.HasParseError()) fail(reader.GetParseErrorCode(), reader.GetErrorOffset());
    if (!object.IsObject())
      throw DatasetError(fmt::format("{} record {}: must be an object", label, record.number_));
    record.take(object);
    on_record(record);
    pool.Clear();
    is_over = skipTo(']');
    if (!is_over && !skipTo(',')) fail(kParseErrorArrayMissCommaOrSquareBracket, input.Tell());
  }
  SkipWhitespace(input);
  if (input.Peek() != '\0') fail(kParseErrorDocumentRootNotSingular, input.Tell());
}

}  // namespace radar_dot::dataset
