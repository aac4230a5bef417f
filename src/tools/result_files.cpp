// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "result_files.h"

#include <csignal>
#include <cstdio>
#include <exception>
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
  for (const std::string& file : {json, csv})
    if (!file.empty()) requireReplaceable(file);
}

void ResultFiles::write(const std::string& parameters, const std::string& json_text,
                        const std::string& csv_text, const std::string& table) const {
  std::exception_ptr failure;
  const auto attempt = [&failure](const auto& work) {
    try {
      work();
    } catch (const std::exception&) {
      if (!failure) failure = std::current_exception();
    }
  };
  // A reader that has gone must not end the process before the files are there.
  std::signal(SIGPIPE, SIG_IGN);
  attempt([&table] {
    if (std::fwrite(table.data(), 1, table.size(), stdout) != table.size() || std::fflush(stdout) != 0)
      throw std::runtime_error("the table cannot be written to standard output");
  });
  if (!json.empty()) attempt([&] { replaceFile(json, withParameters(json_text, parameters)); });
  if (!csv.empty()) attempt([&] { replaceFile(csv, csv_text); });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace radar_dot::tools
