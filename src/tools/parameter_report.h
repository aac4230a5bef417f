// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "radar_dot/common/fields.h"

namespace radar_dot::tools {

/// What a report says of one section.
struct RecordedSection {
  std::string name;
  std::vector<Field> fields;
  std::vector<FieldDictionary> dictionaries;
};

/// {"tool": ..., "<section>": {name: value, ...}, ...}. Numbers read back exactly; infinity is the text
/// "inf", an optional number that is not set null. What repeats a name is left out, as is what has an effect
/// on a live system alone.
std::string parametersJson(const std::string& tool, const std::vector<RecordedSection>& sections);

/// A report of an evaluator, a JSON object, with a member "parameters" in front: what parametersJson() gave.
std::string withParameters(const std::string& report, const std::string& parameters);

}  // namespace radar_dot::tools
