// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "parameter_document.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/evaluation/report.h"

namespace radar_dot::tools {

/// Where an evaluator writes its results, beside the table on standard output.
struct ResultFiles {
  std::string json, csv;  ///< empty: not written

  void describe(FieldList& fields) {
    fields.group("Output");
    fields.add("json", json,
               "JSON file for the results and all parameters in force; --config takes it to repeat the run");
    fields.add("csv", csv, "CSV file for the results");
  }

  /// To be called before the work. @throws InvalidParameter where both name one file.
  void check() const {
    require(json.empty() || json != csv, fieldsOf(*this), {&json, &csv}, "they must differ");
  }

  /// @param parameters  see CommandLine::parametersJson
  /// @throws std::runtime_error naming the file, or standard output, that cannot be written.
  template <typename Report>
  void write(const std::string& parameters, const std::vector<Report>& scenes, const Report& overall) const {
    write(parameters, formatJson(scenes, overall), formatCsv(scenes, overall), formatTable(scenes, overall));
  }
  /// The same of texts.
  void write(const std::string& parameters, const std::string& json_text, const std::string& csv_text,
             const std::string& table) const {
    if (!json.empty()) evaluation::writeFile(json, withParameters(json_text, parameters));
    if (!csv.empty()) evaluation::writeFile(csv, csv_text);
    if (std::fwrite(table.data(), 1, table.size(), stdout) != table.size() || std::fflush(stdout) != 0)
      throw std::runtime_error("the table cannot be written to standard output");
  }
};

}  // namespace radar_dot::tools
