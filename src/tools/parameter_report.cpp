// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_report.h"

#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

#include <cmath>
#include <cstdint>
#include <set>

namespace radar_dot::tools {
namespace {

using JsonWriter = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

void writeText(JsonWriter& writer, const std::string& text) {
  writer.String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
}

struct ValueWriter {
  JsonWriter& writer;
  void operator()(std::monostate) const { writer.Null(); }
  void operator()(bool is) const { writer.Bool(is); }
  void operator()(std::int64_t number) const { writer.Int64(number); }
  void operator()(double number) const {
    // JSON has no infinity.
    if (std::isfinite(number))
      writer.Double(number);
    else
      writeText(writer, toText(number));
  }
  void operator()(const std::string& text) const { writeText(writer, text); }
  void operator()(const std::vector<int>& list) const {
    writer.StartArray();
    for (const int number : list) writer.Int(number);
    writer.EndArray();
  }
  void operator()(const std::vector<std::string>& list) const {
    writer.StartArray();
    for (const std::string& text : list) writeText(writer, text);
    writer.EndArray();
  }
};

template <typename Fields>
void writeMembers(JsonWriter& writer, const Fields& fields,
                  const std::vector<FieldDictionary>& dictionaries) {
  std::set<std::string> written;
  for (const Field& field : fields) {
    if (field.live_only || !written.insert(field.name).second) continue;
    writer.Key(field.name);
    std::visit(ValueWriter{writer}, field.get());
  }
  for (const FieldDictionary& dictionary : dictionaries) {
    if (!written.insert(dictionary.name).second) continue;
    writer.Key(dictionary.name);
    writer.StartObject();
    for (const std::string& key : dictionary.keys()) {
      const FieldList entry = dictionary.entry(key);
      writer.Key(key.c_str());
      writer.StartObject();
      writeMembers(writer, entry, entry.dictionaries());
      writer.EndObject();
    }
    writer.EndObject();
  }
}

}  // namespace

std::string parametersJson(const std::string& tool, const std::vector<RecordedSection>& sections) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  writer.SetFormatOptions(rapidjson::kFormatSingleLineArray);
  writer.StartObject();
  writer.Key("tool");
  writeText(writer, tool);
  for (const RecordedSection& section : sections) {
    writer.Key(section.name.c_str());
    writer.StartObject();
    writeMembers(writer, section.fields, section.dictionaries);
    writer.EndObject();
  }
  writer.EndObject();
  return {buffer.GetString(), buffer.GetSize()};
}

std::string withParameters(const std::string& report, const std::string& parameters) {
  const std::size_t begin = report.find('{') + 1;
  std::string member = "\n    \"parameters\": ";
  for (const char c : parameters) {
    member += c;
    if (c == '\n') member += "    ";  // strings hold no line break as such
  }
  const bool is_empty = report[report.find_first_not_of(" \n", begin)] == '}';
  return report.substr(0, begin) + member + (is_empty ? "\n" : ",") + report.substr(begin);
}

}  // namespace radar_dot::tools
