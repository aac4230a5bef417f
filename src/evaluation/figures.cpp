// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/figures.h"

#include <fmt/format.h>
#include <fmt/printf.h>
#include <rapidjson/error/en.h>
#include <rapidjson/istreamwrapper.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <stdexcept>

#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

/// A figure that does not exist is not finite.
std::string textOf(const Figures::Item& item, const Column& column) {
  if (item.kind == Figures::Kind::kCount) return std::to_string(item.count);
  const double value = column.factor * item.number;
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, column.decimals) : "";
}

std::string textOf(const Figures& figures, const Column& column) {
  const Figures::Item* item = figures.find(column.key);
  return item == nullptr ? "" : textOf(*item, column);
}

}  // namespace

double meanAbsolute(const std::vector<double>& values) {
  Mean mean;
  for (const double value : values) mean.add(std::abs(value));
  return mean.value();
}

double medianAbsolute(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted;
  for (const double value : values) sorted.push_back(std::abs(value));
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

void SumsText::operator()(std::uint64_t& count) {
  if (!reads_) {
    text_ << count << ' ';
    return;
  }
  const std::string word = next();
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  failed_ = failed_ || error != std::errc() || *end != '\0';
}

void SumsText::operator()(double& number) {
  if (!reads_) {
    text_ << fmt::sprintf("%a ", number);
    return;
  }
  const std::string word = next();
  char* end = nullptr;
  number = std::strtod(word.c_str(), &end);
  failed_ = failed_ || word.empty() || *end != '\0';
}

void SumsText::operator()(std::string& word) {
  if (reads_)
    failed_ = failed_ || !(text_ >> std::quoted(word));
  else
    text_ << std::quoted(word) << ' ';
}

std::string SumsText::next() {
  std::string word;
  failed_ = failed_ || !(text_ >> word);
  return word;
}

std::size_t SumsText::size(std::size_t count) {
  std::uint64_t size = count;
  (*this)(size);
  failed_ = failed_ || (reads_ && size > text_.str().size());
  return failed_ ? 0 : size;
}

void Figures::add(const std::string& key, Kind kind, double number, std::uint64_t count, void* member) {
  items_.push_back({path_ + key + suffix_, kind, number, count, is_shown_only_ ? nullptr : member});
}

const Figures::Item* Figures::find(const std::string& key) const {
  const auto found =
      std::find_if(items_.begin(), items_.end(), [&key](const Item& item) { return item.key == key; });
  return found == items_.end() ? nullptr : &*found;
}

void Figures::addParts(const Figures& other) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].add(parts_[i].member, other.parts_[i].member);
}

void Figures::keepParts(SumsText& text) const {
  for (const Part& part : parts_) part.keep(part.member, text);
}

std::string Figures::sums() const {
  SumsText text;
  keepParts(text);
  return text.text();
}

void Figures::readSums(const std::string& text, const std::string& where) const {
  SumsText sums(text);
  keepParts(sums);
  if (!sums.isRead())
    throw std::runtime_error(where + ": field 'sums' is not of this evaluator, or of another version");
}

void Figures::sort() {
  const auto is_nested = [](const Item& item) { return item.kind == Kind::kBegin; };
  if (std::any_of(items_.begin(), items_.end(), is_nested)) return;
  std::stable_sort(items_.begin(), items_.end(),
                   [](const Item& a, const Item& b) { return a.kind < b.kind; });
}

std::string tableOf(const std::string& title, std::size_t width, const std::vector<Row>& rows,
                    const std::vector<Column>& columns, bool rules) {
  std::string text = fmt::format("{:<{}}", title, width);
  std::size_t whole = width;
  for (const Column& column : columns) {
    text += fmt::format("{:>{}}", column.title, column.width);
    whole += column.width;
  }
  const std::string rule = rules ? std::string(whole, '-') + "\n" : "";
  text += "\n" + rule;
  for (const auto& [name, figures] : rows) {
    if (&figures == &rows.back().second) text += rule;
    text += fmt::format("{:<{}}", name, width);
    for (const Column& column : columns) {
      const std::string value = textOf(figures, column);
      text += fmt::format("{:>{}}", value.empty() ? "-" : value, column.width);
    }
    text += "\n";
  }
  return text;
}

std::string csvOf(const std::vector<Row>& rows, const std::vector<Column>& columns) {
  std::string text = "scene";
  for (const Column& column : columns) text += "," + column.title;
  text += "\n";
  for (const auto& [name, figures] : rows) {
    text += name;
    for (const Column& column : columns) text += "," + textOf(figures, column);
    text += "\n";
  }
  return text;
}

std::string csvOf(const std::vector<Figures>& scenes, const Figures& overall) {
  std::vector<Row> rows;
  for (const Figures& scene : scenes) rows.emplace_back(scene.name(), scene);
  rows.emplace_back("overall", overall);
  std::vector<Column> columns;
  for (const Figures::Item& item : overall.items())
    if (item.kind < Figures::Kind::kColumn) columns.push_back({item.key, 0, item.key, 6});
  return csvOf(rows, columns);
}

std::string jsonText(const std::function<void(JsonWriter&)>& write) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  write(writer);
  return std::string(buffer.GetString(), buffer.GetSize()) + "\n";
}

std::string jsonOf(const std::vector<Figures>& scenes, const Figures& overall) {
  return jsonText([&](JsonWriter& writer) { writeScenes(writer, scenes, overall); });
}

void writeReport(JsonWriter& writer, const Figures& figures, bool is_overall) {
  writer.StartObject();
  if (!is_overall) {
    writer.Key("scene");
    writer.String(figures.name().c_str());
  }
  for (const Figures::Item& item : figures.items()) {
    if (item.kind == Figures::Kind::kColumn) continue;
    if (item.kind == Figures::Kind::kEnd) {
      writer.EndObject();
      continue;
    }
    writer.Key(item.key.substr(item.key.rfind('/') + 1).c_str());
    if (item.kind == Figures::Kind::kBegin) {
      writer.StartObject();
    } else if (item.kind == Figures::Kind::kCount) {
      writer.Uint64(item.count);
    } else if (std::isfinite(item.number)) {
      writer.Double(item.number);
    } else {
      writer.Null();
    }
  }
  if (const std::string sums = figures.sums(); !sums.empty()) {
    writer.Key("sums");
    writer.String(sums.c_str());
  }
  writer.EndObject();
}

void writeScenes(JsonWriter& writer, const std::vector<Figures>& scenes, const Figures& overall,
                 const std::function<void()>& more) {
  writer.StartObject();
  writer.Key("scenes");
  writer.StartArray();
  for (const Figures& scene : scenes) writeReport(writer, scene, false);
  writer.EndArray();
  writer.Key("overall");
  writeReport(writer, overall, true);
  more();
  writer.EndObject();
}

rapidjson::Document readReport(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be opened");
  rapidjson::IStreamWrapper wrapper(stream);
  rapidjson::Document document;
  // Not recursive: a file nested deeply is an error, not the end of the stack.
  document.ParseStream<rapidjson::kParseIterativeFlag | rapidjson::kParseFullPrecisionFlag>(wrapper);
  if (document.HasParseError()) {
    throw std::runtime_error(fmt::format("{}: byte {}: {}", file, document.GetErrorOffset(),
                                         rapidjson::GetParseError_En(document.GetParseError())));
  }
  if (!document.IsObject() || !document.HasMember("scenes") || !document["scenes"].IsArray())
    throw std::runtime_error(file + ": has no list 'scenes'; it must be a result of an evaluator's --json");
  return document;
}

const rapidjson::Value& memberOf(const rapidjson::Value& value, const char* key,
                                 bool (rapidjson::Value::*is_valid)() const, const char* wanted,
                                 const std::string& where) {
  if (!value.IsObject()) throw std::runtime_error(where + ": is not an object");
  if (!value.HasMember(key) || !(value[key].*is_valid)())
    throw std::runtime_error(fmt::format("{}: field '{}' is missing or is not {}", where, key, wanted));
  return value[key];
}

}  // namespace radar_dot::evaluation
