// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "radar_dot/config/section.h"

namespace radar_dot::tools {

/// All parameters as a configuration file with the values they have, which readConfigFile() reads back.
std::string parametersYaml(const std::vector<Section>& sections);

/// All parameters as tables, a chapter for each section.
std::string parametersMarkdown(const std::vector<Section>& sections);

/// {"tool": ..., "<section>": {name: value, ...}, ...}, without empty sections. Numbers read back exactly;
/// infinity is the text "inf", an optional number that is not set null. What repeats a name is left out, as
/// is what has an effect on a live system alone.
std::string parametersJson(const std::string& tool, const std::vector<Section>& sections);

/// A report of an evaluator, a JSON object, with a member "parameters" in front: what parametersJson() gave.
std::string withParameters(const std::string& report, const std::string& parameters);
/// The same with "left_out": {what: why, ...}.
std::string withLeftOut(const std::string& report, const std::map<std::string, std::string>& left_out);

}  // namespace radar_dot::tools
