// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

#include <cmath>
#include <cstddef>
#include <string>
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

}  // namespace radar_dot::evaluation
