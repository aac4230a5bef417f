// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rapidjson/document.h>
#include <rapidjson/prettywriter.h>
#include <rapidjson/stringbuffer.h>

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/evaluation/figures.h"

namespace radar_dot::evaluation {

/// A figure in a table, or in a CSV file.
struct Column {
  std::string title;
  std::size_t width;  ///< characters
  std::string key;
  int decimals = 3;
  double factor = 1.0;  ///< of what is shown to the figure
};

/// A name, and the figures beside it.
using Row = std::pair<std::string, Figures>;

/// The scenes and below them what they are together.
template <typename Report>
std::vector<Row> rowsOf(const std::vector<Report>& scenes, const Report& overall,
                        const std::string& overall_name = "Overall") {
  std::vector<Row> rows;
  for (const Report& scene : scenes) rows.emplace_back(scene.scene, figuresOf(scene));
  rows.emplace_back(overall_name, figuresOf(overall));
  return rows;
}

/// A dash stands for a figure that does not exist.
/// @param title, width  of the column of names
/// @param rules         lines of dashes below the titles and above the last row
std::string tableOf(const std::string& title, std::size_t width, const std::vector<Row>& rows,
                    const std::vector<Column>& columns, bool rules = false);

/// Nothing stands for a figure that does not exist.
std::string csvOf(const std::vector<Row>& rows, const std::vector<Column>& columns);

using JsonWriter = rapidjson::PrettyWriter<rapidjson::StringBuffer>;

/// What `write` writes, and a line break.
std::string jsonText(const std::function<void(JsonWriter&)>& write);

/// One object; the overall one has no name.
void writeReport(JsonWriter& writer, const Figures& figures, bool is_overall);

/// {"scenes": [...], "overall": ..., more}; `more()` writes further members.
void writeScenes(
    JsonWriter& writer, const std::vector<Figures>& scenes, const Figures& overall,
    const std::function<void()>& more = [] {});

/// What formatJson has written. @throws std::runtime_error naming file and field for what is no such file.
rapidjson::Document readReport(const std::string& file);

/// A member of an object. @throws std::runtime_error naming `where` and the field
const rapidjson::Value& memberOf(const rapidjson::Value& value, const char* key,
                                 bool (rapidjson::Value::*is_valid)() const, const char* wanted,
                                 const std::string& where);

}  // namespace radar_dot::evaluation
