// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "result_files.h"

#include <cstdio>
#include <stdexcept>

#include "common/replace_file.h"
#include "parameter_document.h"

namespace radar_dot::tools {
void ResultFiles::describe(FieldList& fields) {
  fields.group("Output");
  fields.add("json", json,
             "JSON file for the results and all parameters in force; --config takes it to repeat the run");
  fields.add("csv", csv, "CSV file for the results");
}

void ResultFiles::check() const {
  require(json.empty() || json != csv, fieldsOf(*this), {&json, &csv}, "they must differ");
}

void ResultFiles::write(const std::string& parameters, const std::string& json_text,
                        const std::string& csv_text, const std::string& table) const {
  if (!json.empty()) replaceFile(json, withParameters(json_text, parameters));
  if (!csv.empty()) replaceFile(csv, csv_text);
  if (std::fwrite(table.data(), 1, table.size(), stdout) != table.size() || std::fflush(stdout) != 0)
    throw std::runtime_error("the table cannot be written to standard output");
}

}  // namespace radar_dot::tools
