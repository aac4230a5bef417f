// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

constexpr std::size_t kMaxNumber = 1'000'000'000'000;
constexpr std::size_t kMaxCount = 1'000'000;

std::optional<std::size_t> parseNumber(std::string_view text) {
  std::size_t number = 0;
  for (const char digit : text) {
    if (digit < '0' || digit > '9' || number > kMaxNumber) return std::nullopt;
    number = 10 * number + static_cast<std::size_t>(digit - '0');
  }
  return text.empty() ? std::nullopt : std::optional<std::size_t>(number);
}

std::optional<ScalarType> scalarType(std::string_view type, std::string_view size) {
  if (type.size() != 1 || size.size() != 1) return std::nullopt;
  switch (type[0] * 10 + (size[0] - '0')) {
    case 'I' * 10 + 1: return ScalarType::kInt8;
    case 'I' * 10 + 2: return ScalarType::kInt16;
    case 'I' * 10 + 4: return ScalarType::kInt32;
    case 'U' * 10 + 1: return ScalarType::kUint8;
    case 'U' * 10 + 2: return ScalarType::kUint16;
    case 'U' * 10 + 4: return ScalarType::kUint32;
    case 'F' * 10 + 4: return ScalarType::kFloat32;
    case 'F' * 10 + 8: return ScalarType::kFloat64;
    default: return std::nullopt;
  }
}

/// Goes through the lines up to DATA and then puts their entries together.
class HeaderParser {
 public:
  HeaderParser(std::string_view content, const std::filesystem::path& file)
      : content_(content), file_(file) {}

  PcdHeader parse() {
    while (!has_data_) parseLine(nextLine());
    PcdHeader header;
    header.encoding = encoding_;
    header.data_offset = position_;
    readColumns(header);
    header.points = points();
    return header;
  }

 private:
  /// Values of an entry and the line they stand in; line 0 = absent.
  struct Entry {
    std::vector<std::string_view> values;
    std::size_t line = 0;
  };

  [[noreturn]] void fail(std::size_t line, std::string_view complaint) const {
    throw DatasetError(fmt::format("{}: header line {}: {}", file_.string(), line, complaint));
  }

  std::string_view nextLine() {
    const std::size_t end = content_.find('\n', position_);
    if (end == std::string_view::npos)
      throw DatasetError(
          fmt::format("{}: no DATA line, so this is no PCD file or only the start of one", file_.string()));
    const std::string_view line = content_.substr(position_, end - position_);
    position_ = end + 1;
    ++line_;
    return line;
  }

  void parseLine(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t start = line.find_first_not_of(" \t\r"); start != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
      words.push_back(line.substr(start, end - start));
      start = line.find_first_not_of(" \t\r", end);
    }
    if (words.empty() || words[0][0] == '#') return;
    const std::string_view keyword = words[0];
    words.erase(words.begin());
    if (keyword == "VERSION" || keyword == "VIEWPOINT") return;
    if (keyword == "DATA") return readEncoding(words);
    const std::pair<std::string_view, Entry*> entries[] = {
        {"FIELDS", &names_}, {"SIZE", &sizes_},    {"TYPE", &types_},   {"COUNT", &counts_},
        {"WIDTH", &width_},  {"HEIGHT", &height_}, {"POINTS", &points_}};
    for (const auto& [name, entry] : entries) {
      if (keyword != name) continue;
      *entry = {std::move(words), line_};
      return;
    }
    fail(line_, fmt::format("'{}' is no entry of a PCD header", printable(keyword)));
  }

  void readEncoding(const std::vector<std::string_view>& words) {
    const std::string_view encoding = words.size() == 1 ? words[0] : "";
    if (encoding == "binary_compressed")
      fail(line_,
           "DATA binary_compressed is not supported; convert the file to binary or ascii "
           "(pcl_convert_pcd_ascii_binary IN OUT 1)");
    if (encoding != "binary" && encoding != "ascii") fail(line_, "DATA must be binary or ascii");
    encoding_ = encoding == "binary" ? PcdEncoding::kBinary : PcdEncoding::kAscii;
    has_data_ = true;
  }

  void readColumns(PcdHeader& header) const {
    if (names_.values.empty()) fail(line_, "the header names no FIELDS");
    requireLength(sizes_, "SIZE");
    requireLength(types_, "TYPE");
    if (counts_.line != 0) requireLength(counts_, "COUNT");
    for (std::size_t i = 0; i < names_.values.size(); ++i) {
      PcdColumn column;
      column.field.name = names_.values[i];
      column.is_gap = column.field.name == "_";
      const auto type = scalarType(types_.values[i], sizes_.values[i]);
      if (!type)
        fail(types_.line,
             fmt::format("field '{}' has TYPE {} of SIZE {}; known are I and U of 1, 2, 4 and F of 4, 8",
                         column.field.name, types_.values[i], sizes_.values[i]));
      column.field.type = *type;
      if (counts_.line != 0) {
        const auto count = parseNumber(counts_.values[i]);
        if (!count || *count == 0 || *count > kMaxCount)
          fail(counts_.line, fmt::format("field '{}' has COUNT {}", column.field.name, counts_.values[i]));
        column.field.count = static_cast<std::uint32_t>(*count);
      }
      const bool is_twin =
          std::any_of(header.columns.begin(), header.columns.end(),
                      [&](const PcdColumn& other) { return other.field.name == column.field.name; });
      if (is_twin && !column.is_gap)
        fail(names_.line, fmt::format("field '{}' appears twice", column.field.name));
      column.field.offset = static_cast<std::uint32_t>(header.record_size);
      header.record_size += column.bytes();
      header.columns.push_back(std::move(column));
    }
  }

  void requireLength(const Entry& entry, std::string_view name) const {
    if (entry.line == 0) fail(line_, fmt::format("the header has no {}", name));
    if (entry.values.size() != names_.values.size())
      fail(entry.line,
           fmt::format("{} has {} values for {} FIELDS", name, entry.values.size(), names_.values.size()));
  }

  std::size_t points() const {
    std::optional<std::size_t> area;
    if (width_.line != 0)
      area = single(width_, "WIDTH") * (height_.line != 0 ? single(height_, "HEIGHT") : 1);
    if (points_.line == 0) {
      if (!area) fail(line_, "the header has neither POINTS nor WIDTH");
      return *area;
    }
    const std::size_t count = single(points_, "POINTS");
    if (area && *area != count)
      fail(points_.line, fmt::format("POINTS is {} but WIDTH x HEIGHT is {}", count, *area));
    return count;
  }

  std::size_t single(const Entry& entry, std::string_view name) const {
    const auto number = entry.values.size() == 1 ? parseNumber(entry.values[0]) : std::nullopt;
    if (!number || *number > UINT32_MAX) fail(entry.line, fmt::format("{} must be one whole number", name));
    return *number;
  }

  static std::string printable(std::string_view text) {
    std::string shown(text.substr(0, 20));
    for (char& letter : shown)
      if (letter < ' ' || letter > '~') letter = '?';
    return shown;
  }

  std::string_view content_;
  const std::filesystem::path& file_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  Entry names_, sizes_, types_, counts_, width_, height_, points_;
  PcdEncoding encoding_ = PcdEncoding::kBinary;
  bool has_data_ = false;
};

}  // namespace

PcdHeader parsePcdHeader(std::string_view content, const std::filesystem::path& file) {
  return HeaderParser(content, file).parse();
}

}  // namespace radar_dot::dataset
