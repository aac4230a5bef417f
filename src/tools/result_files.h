// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "radar_dot/evaluation/report.h"

namespace radar_dot::tools {

/// Where an evaluator writes its results, beside the table on standard output.
struct ResultFiles {
  std::string json, csv;  ///< empty: not written

  void declare(CLI::App& app) {
    app.add_option("--json", json, "Write the results to this JSON file");
    app.add_option("--csv", csv, "Write the results to this CSV file");
  }

  /// To be called before the work. @throws std::invalid_argument where both name one file.
  void check() const {
    if (!json.empty() && json == csv)
      throw std::invalid_argument("--json and --csv name the same file, " + json);
  }

  /// @throws std::runtime_error naming the file, or standard output, that cannot be written.
  template <typename Report>
  void write(const std::vector<Report>& scenes, const Report& overall) const {
    write(formatJson(scenes, overall), formatCsv(scenes, overall), formatTable(scenes, overall));
  }
  /// The same of texts.
  void write(const std::string& json_text, const std::string& csv_text, const std::string& table) const {
    if (!json.empty()) evaluation::writeFile(json, json_text);
    if (!csv.empty()) evaluation::writeFile(csv, csv_text);
    if (std::fwrite(table.data(), 1, table.size(), stdout) != table.size() || std::fflush(stdout) != 0)
      throw std::runtime_error("the table cannot be written to standard output");
  }
};

}  // namespace radar_dot::tools
