// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "merged_reports.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

using rapidjson::Value;

/// What may differ between parts of one result.
constexpr const char* kOfParts[] = {"dataroot", "scenes", "jobs"};

void addScenes(const Value& list, const std::string& file, std::vector<SavedReports::Scene>& scenes) {
  std::size_t record = 0;
  for (const Value& value : list.GetArray()) {
    const std::string where = fmt::format("{}: scene {}", file, record++);
    scenes.push_back({memberOf(value, "scene", &Value::IsString, "a text", where).GetString(),
                      memberOf(value, "sums", &Value::IsString, "a text", where).GetString(), where});
    for (std::size_t i = 0; i + 1 < scenes.size(); ++i)
      if (scenes[i].name == scenes.back().name)
        throw std::runtime_error(fmt::format("{}: {} also stands in {}; it would count twice", where,
                                             scenes[i].name, scenes[i].where));
  }
}

/// The parameters of a report, without what may differ.
rapidjson::Document commonOf(const Value& parameters) {
  rapidjson::Document common;
  common.CopyFrom(parameters, common.GetAllocator());
  if (common.HasMember("options") && common["options"].IsObject())
    for (const char* name : kOfParts) common["options"].RemoveMember(name);
  return common;
}

/// The first member that differs, with its section.
std::string differenceOf(const Value& one, const Value& other) {
  for (const auto& member : other.GetObject())
    if (!one.HasMember(member.name)) return member.name.GetString();
  for (const auto& member : one.GetObject()) {
    std::string name = member.name.GetString();
    const auto found = other.FindMember(member.name);
    if (found == other.MemberEnd()) return name;
    if (member.value == found->value) continue;
    const bool are_sections = member.value.IsObject() && found->value.IsObject();
    return are_sections ? name + " " + differenceOf(member.value, found->value) : name;
  }
  return "";
}

void requireSame(const Value& first, const std::string& first_file, const Value& parameters,
                 const std::string& file) {
  const std::string difference = differenceOf(commonOf(first), commonOf(parameters));
  if (!difference.empty())
    throw std::runtime_error(
        fmt::format("{}: its parameters differ from those of {}: {}", file, first_file, difference));
}

/// With the names of the scenes.
std::string textOf(rapidjson::Document& parameters, const std::vector<SavedReports::Scene>& scenes) {
  auto& allocator = parameters.GetAllocator();
  if (parameters.HasMember("options") && parameters["options"].IsObject()) {
    Value names(rapidjson::kArrayType);
    for (const SavedReports::Scene& scene : scenes)
      names.PushBack(Value(scene.name.c_str(), allocator), allocator);
    parameters["options"]["scenes"] = names;
  }
  std::string text = jsonText([&parameters](JsonWriter& writer) {
    writer.SetFormatOptions(rapidjson::kFormatSingleLineArray);
    parameters.Accept(writer);
  });
  text.pop_back();
  return text;
}

}  // namespace

SavedReports readReports(const std::string& tool, const std::vector<std::string>& files) {
  SavedReports reports;
  std::optional<rapidjson::Document> first;
  bool all_have_parameters = true;
  for (const std::string& file : files) {
    const rapidjson::Document document = readReport(file);
    addScenes(document["scenes"], file, reports.scenes);
    if (document.HasMember("left_out")) {
      const Value& entries = memberOf(document, "left_out", &Value::IsObject, "an object", file);
      for (const auto& entry : entries.GetObject()) {
        const char* what = entry.name.GetString();
        reports.left_out[what] = memberOf(entries, what, &Value::IsString, "a text", file).GetString();
      }
    }
    if (!document.HasMember("parameters")) {
      all_have_parameters = false;
      continue;
    }
    const Value& parameters = memberOf(document, "parameters", &Value::IsObject, "an object", file);
    if (memberOf(parameters, "tool", &Value::IsString, "a text", file).GetString() != tool)
      throw std::runtime_error(fmt::format("{}: is a result of {}", file, parameters["tool"].GetString()));
    if (first) {
      requireSame(*first, files.front(), parameters, file);
    } else {
      first.emplace();
      first->CopyFrom(parameters, first->GetAllocator());
    }
  }
  for (const SavedReports::Scene& scene : reports.scenes) reports.left_out.erase(scene.name);
  if (first && all_have_parameters) reports.parameters = textOf(*first, reports.scenes);
  return reports;
}

}  // namespace radar_dot::evaluation
