// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace radar_dot::evaluation {

using JsonWriter = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

/// A figure, or a dash where there is none.
inline std::string figure(double value, int decimals = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

/// A member that is null where there is no figure.
inline void number(JsonWriter& writer, const char* key, double value) {
  writer.Key(key);
  if (std::isfinite(value)) {
    writer.Double(value);
  } else {
    writer.Null();
  }
}

inline void count(JsonWriter& writer, const char* key, std::size_t value) {
  writer.Key(key);
  writer.Uint64(value);
}

/// {"scenes": [...], "overall": ..., more}; `write(report, is_overall)` writes one of them, `more()` further
/// members.
template <typename Report, typename Write, typename More>
void writeScenes(JsonWriter& writer, const std::vector<Report>& scenes, const Report& overall,
                 const Write& write, const More& more) {
  writer.StartObject();
  writer.Key("scenes");
  writer.StartArray();
  for (const Report& scene : scenes) write(scene, false);
  writer.EndArray();
  writer.Key("overall");
  write(overall, true);
  more();
  writer.EndObject();
}

template <typename Report, typename Write>
void writeScenes(JsonWriter& writer, const std::vector<Report>& scenes, const Report& overall,
                 const Write& write) {
  writeScenes(writer, scenes, overall, write, [] {});
}

/// Name and value, in the order of the files.
using Figures = std::vector<std::pair<std::string, double>>;
using Counts = std::vector<std::pair<std::string, std::uint64_t>>;

/// A JSON file of reports that have a name, figures and counts, by `figures_of(report)` and
/// `counts_of(report)`.
template <typename Report, typename FiguresOf, typename CountsOf>
std::string jsonOf(const std::vector<Report>& scenes, const Report& overall, const FiguresOf& figures_of,
                   const CountsOf& counts_of) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  writeScenes(writer, scenes, overall, [&](const Report& report, bool is_overall) {
    writer.StartObject();
    if (!is_overall) {
      writer.Key("scene");
      writer.String(report.scene.c_str());
    }
    for (const auto& [key, value] : figures_of(report)) number(writer, key.c_str(), value);
    for (const auto& [key, value] : counts_of(report)) count(writer, key.c_str(), value);
    writer.EndObject();
  });
  return std::string(buffer.GetString(), buffer.GetSize()) + "\n";
}

/// The same as columns.
template <typename Report, typename FiguresOf, typename CountsOf>
std::string csvOf(const std::vector<Report>& scenes, const Report& overall, const FiguresOf& figures_of,
                  const CountsOf& counts_of) {
  std::string text = "scene";
  for (const auto& [key, value] : figures_of(overall)) text += "," + key;
  for (const auto& [key, value] : counts_of(overall)) text += "," + key;
  text += "\n";
  const auto line = [&](const Report& report, const std::string& name) {
    text += name;
    for (const auto& [key, value] : figures_of(report))
      text += std::isfinite(value) ? fmt::format(",{:.6f}", value) : ",";
    for (const auto& [key, value] : counts_of(report)) text += fmt::format(",{}", value);
    text += "\n";
  };
  for (const Report& scene : scenes) line(scene, scene.scene);
  line(overall, "overall");
  return text;
}

}  // namespace radar_dot::evaluation
