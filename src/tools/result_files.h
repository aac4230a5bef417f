// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "radar_dot/common/fields.h"

namespace radar_dot::tools {

/// Where an evaluator writes its results, beside the table on standard output.
struct ResultFiles {
  std::string json, csv;  ///< empty: not written

  void describe(FieldList& fields);

  /// To be called before the work. @throws InvalidParameter where both name one file, std::runtime_error
  /// naming one that cannot be written.
  void check() const;

  /// The table comes first, and nothing that fails keeps the rest from being written. A failure leaves the
  /// old file, or none. Links are followed; devices and pipes are written to directly.
  /// @param parameters  see CommandLine::parametersJson
  /// @throws std::runtime_error naming the file, or standard output, that cannot be written.
  void write(const std::string& parameters, const std::string& json_text, const std::string& csv_text,
             const std::string& table) const;
};

}  // namespace radar_dot::tools
